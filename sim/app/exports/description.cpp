#include "sim/app/exports/description.hpp"

#include <algorithm>
#include <array>
#include <string>
#include <string_view>
#include <utility>

#include "firmware/dcon/commands.hpp"
#include "firmware/dcon/writing.hpp"
#include "firmware/modbus/functions.hpp"
#include "firmware/model/baud.hpp"
#include "firmware/registers/bits.hpp"
#include "firmware/registers/words.hpp"

namespace ex9000::sim {

namespace {

using Json = nlohmann::ordered_json;

Json text_or_null(std::string_view text) { return text.empty() ? Json() : Json(text); }

/// Lower-case letters, digits and `_`.
std::string key_of(std::string_view name) {
  std::string key;
  for (const char c : name) {
    key += c == '-' || c == ' ' ? '_' : c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
  }
  return key;
}

template <class Has>
bool any_has(const Models& models, Has has) {
  return std::any_of(models.begin(), models.end(), [&](const Model* model) { return has(*model); });
}

/// The models that meet a row's needs, in the order of Needs.
constexpr std::array<const char*, 4> kWhichModels{"all", "with outputs", "with inputs", "-M"};

std::string which_models(Needs needs) { return kWhichModels[static_cast<std::size_t>(needs)]; }

Json commands(const Models& models) {
  Json all = Json::array();
  for (const dcon::Command& command : dcon::kCommands) {
    if (any_has(models, [&](const Model& model) { return meets(model, command.dispatch.needs); })) {
      const char* const access = command.access == dcon::Access::Read    ? "read"
                                 : command.access == dcon::Access::Write ? "write"
                                                                         : "stored";
      all.push_back({{"id", command.id},
                     {"command", command.syntax},
                     {"reply", text_or_null(command.reply)},
                     {"meaning", command.meaning},
                     {"arguments", text_or_null(command.range)},
                     {"access", access},
                     {"needs_init", command.dispatch.init != dcon::Init::NotRequired},
                     {"which_models", which_models(command.dispatch.needs)}});
    }
  }
  return all;
}

/// Formats a reply in which only this channel is on, and finds the byte that is not 0.
std::size_t data_byte_of(const Model& model, bool is_output, unsigned channel) {
  const auto on = static_cast<std::uint16_t>(1U << channel);
  ex9000::Reply reply;
  reply.clear();
  dcon::put_data(model, is_output ? on : std::uint16_t{0}, is_output ? std::uint16_t{0} : on, reply);
  const auto digit =
      std::find_if(reply.bytes().begin(), reply.bytes().end(), [](std::uint8_t c) { return c != '0'; });
  return static_cast<std::size_t>(digit - reply.bytes().begin()) / 2;
}

/// `byte`: 0 (First) or 1 (Second) of DCON replies. For example `DO8-12`; `00`: no channel.
std::string data_byte(const Model& model, std::size_t byte) {
  for (const bool is_output : {true, false}) {
    std::vector<std::string> held;
    for (unsigned channel = 0; channel < (is_output ? model.outputs : model.inputs); ++channel) {
      if (data_byte_of(model, is_output, channel) == byte) {
        held.push_back(std::to_string(channel));
      }
    }
    if (!held.empty()) {
      return (is_output ? "DO" : "DI") + held.front() + (held.size() > 1 ? "-" + held.back() : "");
    }
  }
  return "00";
}

Json functions(const Models& models) {
  Json all = Json::array();
  for (const modbus::Function& function : modbus::kFunctions) {
    const Needs needs = function.row.needs;
    if (any_has(models, [=](const Model& model) { return model.speaks_modbus() && meets(model, needs); })) {
      all.push_back({{"code", function.row.code},
                     {"name", function.name},
                     {"by_broadcast", function.row.at_broadcast == modbus::AtBroadcast::CarriedOut},
                     {"which_models", needs == Needs::Nothing ? "-M" : "-M " + which_models(needs)}});
    }
  }
  return all;
}

/// One of the four tables of Modbus.
struct Table {
  const char* name = "";  ///< name of one item of the table
  char digit = '0';       ///< first digit of the table's PLC numbers
  registers::Functions reads = 0;
  registers::Functions writes = 0;
};

constexpr std::array<Table, 4> kTables{{
    {"coil", '0', registers::kReadCoils, registers::kWriteSingleCoil | registers::kWriteMultipleCoils},
    {"discrete input", '1', registers::kReadDiscreteInputs, 0},
    {"input register", '3', registers::kReadInputRegisters, 0},
    {"holding register", '4', registers::kReadHoldingRegisters, registers::kWriteRegisters},
}};

Json function_codes(registers::Functions functions) {
  Json codes = Json::array();
  for (unsigned function = 0; function < 16; ++function) {
    if ((functions >> function & 1U) != 0) {
      codes.push_back(function);
    }
  }
  if ((functions & registers::kWriteRegisters) != 0) {
    codes.push_back(0x10);
  }
  return codes;
}

/// Counts from 1; has at least four digits after the digit of the table.
std::string plc_number(const Table& table, unsigned address) {
  constexpr std::size_t kDigits = 4;
  const std::string number = std::to_string(address + 1);
  return table.digit + std::string(number.size() < kDigits ? kDigits - number.size() : 0, '0') + number;
}

/// The row of a model, which must support Modbus, if the model has it in this table.
template <class Register>
void add_register(const Model& model, const Table& table, const Register& entry, Json& all) {
  const auto& row = entry.row;
  // Only host OK lists no functions: the firmware detects it without kWordRegisters. Masters send 03 or 04.
  const registers::Functions functions = row.functions != 0 ? row.functions : registers::kReadRegisters;
  const bool reads = (functions & table.reads) != 0;
  const bool writes = (functions & table.writes) != 0;
  if (!meets(model, row.needs) || (!reads && !writes)) {
    return;
  }
  const unsigned count = registers::width_of(row.width, model);
  const bool per_channel =
      row.width == registers::Width::PerOutput || row.width == registers::Width::PerInput;
  Json items = Json::array();
  for (unsigned index = 0; index < count; ++index) {
    items.push_back({{"address", row.first + index},
                     {"plc_number", plc_number(table, row.first + index)},
                     {"channel", per_channel ? Json(index) : Json()}});
  }
  all.push_back({{"id", entry.id},
                 {"table", table.name},
                 {"first", row.first},
                 {"last", row.first + count - 1},
                 {"plc_first", items.front()["plc_number"]},
                 {"plc_last", items.back()["plc_number"]},
                 {"count", count},
                 {"per_channel", per_channel},
                 {"functions", function_codes(functions & (table.reads | table.writes))},
                 {"access", reads && writes ? "read, write"
                            : reads         ? "read"
                                            : "write"},
                 {"range", writes ? text_or_null(entry.range) : Json()},
                 {"meaning", entry.meaning},
                 {"items", std::move(items)}});
}

Json registers_of(const Model& model) {
  Json all = Json::array();
  if (!model.speaks_modbus()) {
    return all;
  }
  for (const Table& table : kTables) {
    for (const registers::BitRegister& entry : registers::kBitRegisters) {
      add_register(model, table, entry, all);
    }
    for (const registers::WordRegister& entry : registers::kWordRegisters) {
      add_register(model, table, entry, all);
    }
  }
  return all;
}

/// What tools show. Not shown are rows that repeat a row, the extensions, and the settings whose change would
/// disconnect the client after a reset.
struct Shown {
  std::string_view id;
  /// output: read and written; input: a level or a latch; counter: continues with 0 after its highest value;
  /// preset: a stored value of the outputs, not written, because that also drives them; state: both on and
  /// off are normal; problem: on is one; tenths: of 0.1 s; button: a coil that starts an action at a 1.
  std::string_view role;
  std::string_view name;  ///< without the channel; unique
};

constexpr Shown kShown[] = {
    {"outputs", "output", "Output"},
    {"inputs", "input", "Input"},
    {"latch-high", "input", "Latch high"},
    {"latch-low", "input", "Latch low"},
    {"safe-value", "preset", "Safe value"},
    {"power-on-value", "preset", "Power-on value"},
    {"watchdog-enable", "state", "Host watchdog enabled"},
    {"clear-latches", "button", "Clear latches"},
    {"timeout-status", "problem", "Host watchdog timeout status"},
    {"timeout-status", "button", "Clear timeout status"},
    {"clear-counters", "button", "Clear counter"},
    {"counters", "counter", "Counter"},
    {"watchdog-timeout", "tenths", "Host watchdog timeout"},
};

/// `written` counts the channels that tools write.
Json entity(const Shown& shown, const Json& row, std::size_t number, unsigned& written) {
  const bool is_written = shown.role == "output" || shown.role == "button";
  Json channels = Json::array();
  for (const Json& item : row["items"]) {
    const Json& channel = item["channel"];
    const std::string name = std::string(shown.name) + (channel.is_null() ? "" : " " + channel.dump());
    written += is_written ? 1 : 0;
    channels.push_back({{"name", name},
                        {"key", key_of(name)},
                        {"address", item["address"]},
                        {"row", is_written ? Json(written) : Json()}});
  }
  return {{"name", shown.name},
          {"key", key_of(shown.name)},
          {"role", shown.role},
          {"table", row["table"]},
          {"first", row["first"]},
          {"count", row["count"]},
          {"row", number},
          {"per_channel", row["per_channel"]},
          {"channels", std::move(channels)}};
}

/// A row in two tables appears once, for the first of them.
Json entities_of(const Json& registers) {
  Json all = Json::array();
  unsigned written = 0;
  for (const Json& row : registers) {
    for (const Shown& shown : kShown) {
      const auto same = [&](const Json& each) { return each["name"] == shown.name; };
      if (row["id"] == shown.id && std::none_of(all.begin(), all.end(), same)) {
        all.push_back(entity(shown, row, all.size() + 1, written));
      }
    }
  }
  return all;
}

/// The first address of each row, by the key of its id.
Json addresses_of(const Json& registers) {
  Json all = Json::object();
  for (const Json& row : registers) {
    all.emplace(key_of(row["id"].get<std::string>()), Json(row["first"]));
  }
  return all;
}

Json described(const Model& model) {
  Json registers = registers_of(model);
  Json addresses = addresses_of(registers);
  Json entities = entities_of(registers);
  return {{"model", model.designation},
          {"model_key", key_of(model.designation)},
          {"description", model.description},
          {"inputs", model.inputs},
          {"outputs", model.outputs},
          {"protocols", model.speaks_modbus() ? Json{"ascii", "modbus-rtu"} : Json::array({"ascii"})},
          {"factory_name", model.factory_name},
          {"longest_name", model.longest_name},
          {"modbus_code", model.speaks_modbus() ? Json(model.modbus_code) : Json()},
          {"first_data_byte", data_byte(model, 0)},
          {"second_data_byte", data_byte(model, 1)},
          {"status_readings", model.status_style == StatusStyle::TimeoutOnly ? "00, 04" : "00, 80, 84"},
          {"dcon_commands", commands({&model})},
          {"modbus_functions", functions({&model})},
          {"modbus_registers", std::move(registers)},
          {"addresses", std::move(addresses)},
          {"entities", std::move(entities)}};
}

Json baud_codes() {
  Json codes = Json::array();
  for (std::uint8_t code = kFirstBaudCode; code <= kLastBaudCode; ++code) {
    codes.push_back({{"code", code}, {"baud", baud_rate(code)}});
  }
  return codes;
}

}  // namespace

Models all_models() {
  Models models;
  for (const Model& model : kModels) {
    models.push_back(&model);
  }
  return models;
}

nlohmann::ordered_json description(const Models& models) {
  Json all = Json::array();
  for (const Model* model : models) {
    all.push_back(described(*model));
  }
  return {{"firmware", kFirmwareVersion},
          {"factory_baud", baud_rate(kFactoryBaudCode)},
          {"baud_codes", baud_codes()},
          {"several", models.size() > 1},
          {"has_inputs", any_has(models, [](const Model& model) { return model.has_inputs(); })},
          {"has_outputs", any_has(models, [](const Model& model) { return model.has_outputs(); })},
          {"has_modbus", any_has(models, [](const Model& model) { return model.speaks_modbus(); })},
          {"dcon_commands", commands(models)},
          {"modbus_functions", functions(models)},
          {"models", std::move(all)}};
}

}  // namespace ex9000::sim
