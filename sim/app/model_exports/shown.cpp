#include "sim/app/model_exports/shown.hpp"

#include <algorithm>
#include <boost/algorithm/string/case_conv.hpp>
#include <optional>

namespace ex9000::sim {

namespace {

/// How exports for Modbus clients present a row of kBitRegisters or kWordRegisters. These tables contain all
/// other data of the row.
struct Reading {
  std::string_view id;
  std::optional<Role> role;  ///< nullopt: the value of the row is not shown
  std::string_view name;
  // The id and the name of the row's button; empty: there is no button.
  std::string_view button_id{};
  std::string_view button_name{};
};

constexpr Reading kReadings[] = {
    {"outputs", Role::Output, "Output"},
    {"inputs", Role::Input, "Input"},
    {"input-coils", std::nullopt, ""},  // the same values as the inputs
    {"latch-high", Role::Input, "Latch high"},
    {"latch-low", Role::Input, "Latch low"},
    {"safe-value", Role::Preset, "Safe value"},
    {"power-on-value", Role::Preset, "Power-on value"},
    {"protocol", std::nullopt, ""},
    {"watchdog-enable", Role::State, "Host watchdog enabled"},
    {"clear-latches", std::nullopt, "", "clear-latches", "Clear latches"},
    {"timeout-status", Role::Problem, "Host watchdog timeout status", "clear-timeout-status",
     "Clear timeout status"},
    {"clear-counters", std::nullopt, "", "clear-counters", "Clear counter"},
    {"counting-edge", std::nullopt, ""},
    {"counters", Role::Counter, "Counter"},
    {"module-code", std::nullopt, ""},
    {"address", std::nullopt, ""},
    {"baud-code", std::nullopt, ""},
    {"watchdog-timeout", Role::Tenths, "Host watchdog timeout"},
    {"input-filters", std::nullopt, ""},
    {"inverted-inputs", std::nullopt, ""},
    {"watchdog-feed", std::nullopt, ""},
    {"response-delay", std::nullopt, ""},
    {"long-counters", std::nullopt, ""},
    {"timed-outputs", std::nullopt, ""},
    {"version", std::nullopt, ""},
    {"reset-reason", std::nullopt, ""},
    {"uptime", std::nullopt, ""},
    {"timeout-count", std::nullopt, ""},
    {"store-count", std::nullopt, ""},
    {"settings-source", std::nullopt, ""},
    {"line-tallies", std::nullopt, ""},
    {"host-ok", std::nullopt, ""},
};

constexpr const Reading* reading_of(std::string_view id) {
  for (const Reading& each : kReadings) {
    if (each.id == id) {
      return &each;
    }
  }
  return nullptr;
}

/// Returns true if two conditions are met. First, kReadings has one entry for each row of kBitRegisters and
/// kWordRegisters, and no other entries. Second, a row of kBitRegisters has a button if, and only if, it has
/// the rule kOnlyOn. For each new row of kBitRegisters or kWordRegisters, add an entry to kReadings.
constexpr bool covers_every_row() {
  for (const registers::BitRegister& row : registers::kBitRegisters) {
    const Reading* const reading = reading_of(row.id);
    if (reading == nullptr || reading->button_id.empty() == row.row.has(registers::kOnlyOn)) {
      return false;
    }
  }
  for (const registers::WordRegister& row : registers::kWordRegisters) {
    if (reading_of(row.id) == nullptr) {
      return false;
    }
  }
  return std::size(kReadings) == std::size(registers::kBitRegisters) + std::size(registers::kWordRegisters);
}
static_assert(covers_every_row());

Shown shown(const MapRow& row, std::string_view id, Role role, std::string_view name) {
  return {id, role, name, row.area->table, row.first, row.last - row.first + 1, row.per_channel};
}

}  // namespace

std::string Shown::name_of(unsigned index) const {
  return std::string(name) + (per_channel ? " " + std::to_string(index) : "");
}

std::string Shown::key_of(unsigned index) const {
  return key() + (per_channel ? "_" + std::to_string(index) : "");
}

std::string Shown::key() const {
  std::string key(id);
  std::replace(key.begin(), key.end(), '-', '_');
  return key;
}

std::vector<Shown> shown_by(const Model& model) {
  std::vector<Shown> all;
  for (const MapRow& row : register_map(model)) {
    const Reading& reading = *reading_of(row.id);
    const auto same = [&row](const Shown& each) { return each.id == row.id; };
    if (reading.role && row.reads && std::none_of(all.begin(), all.end(), same)) {
      all.push_back(shown(row, row.id, *reading.role, reading.name));
    }
    if (!reading.button_id.empty()) {
      all.push_back(shown(row, reading.button_id, Role::Button, reading.button_name));
    }
  }
  return all;
}

std::string model_key(const Model& model) {
  std::string key = boost::to_lower_copy(std::string(model.designation));
  std::replace(key.begin(), key.end(), '-', '_');
  return key;
}

}  // namespace ex9000::sim
