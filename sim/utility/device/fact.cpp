#include "sim/utility/device/fact.hpp"

#include <algorithm>

#include "firmware/update/update.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"
#include "sim/utility/device/channels.hpp"
#include "sim/utility/modbus/register_map.hpp"

namespace ex9000::utility {

namespace {

constexpr unsigned kBitsOfAByte = 8;

constexpr unsigned kResetReason = registers_of("reset-reason");
constexpr unsigned kSecondsUp = registers_of("uptime");
constexpr unsigned kTimeouts = registers_of("timeout-count");
constexpr unsigned kStores = registers_of("store-count");
constexpr unsigned kSettingsSource = registers_of("settings-source");
constexpr unsigned kLineTallies = registers_of("line-tallies");
constexpr unsigned kLineTalliesCount = size_of("line-tallies");
constexpr unsigned kUpdateState = registers_of("update-state");

std::string bits_text(unsigned bits, unsigned channels) {
  std::string text = sim::hex_word_text(bits);
  return channels > kBitsOfAByte ? text : text.substr(2);
}

std::string outputs_text(Device& device, const Model& model) {
  return bits_text(outputs_of(device, model), model.outputs);
}

std::string inputs_text(Device& device, const Model& model) {
  return bits_text(inputs_of(device, model), model.inputs);
}

template <bool kHigh>
std::string latches_text(Device& device, const Model& model) {
  return bits_text(latches_of(device, model, kHigh), model.inputs);
}

std::string counters_text(Device& device, const Model& model) {
  sim::Words texts;
  for (const std::uint32_t count : counters_of(device, model)) {
    texts.push_back(std::to_string(count));
  }
  return sim::joined(texts);
}

std::string near_their_end(const std::string& value) {
  constexpr unsigned kModbusNear = 60'000;
  const sim::Words texts = sim::words_of(value);
  const bool near = std::any_of(texts.begin(), texts.end(),
                                [](const std::string& text) { return std::stoul(text) >= kModbusNear; });
  return near ? "a counter is near its end, after which it begins at 0: 65535 in Modbus, 99999 in ASCII" : "";
}

std::string timeout_status(Device& device, const Model& /*model*/) {
  return has_timed_out(device) ? "set" : "clear";
}

std::string plain(unsigned value) { return std::to_string(value); }

std::string one_of(unsigned value, const sim::Words& texts) {
  return value < texts.size() ? texts[value] : std::to_string(value);
}

}  // namespace

const std::vector<Fact> facts{
    {"outputs", Needs::Outputs, true, outputs_text},
    {"inputs", Needs::Inputs, true, inputs_text},
    {"latch high", Needs::Inputs, true, latches_text<true>},
    {"latch low", Needs::Inputs, true, latches_text<false>},
    {"counters", Needs::Inputs, true, counters_text, near_their_end},
    {"timeout status", Needs::Nothing, true, timeout_status,
     [](const std::string& value) -> std::string {
       return value == "set"
                  ? "the host watchdog has timed out: outputs are blocked until ~AA1 or coil 0x010D"
                  : "";
     }},
    {"timeouts", Needs::Nothing, false,
     [](Device& device, const Model& /*model*/) { return plain(device.extension(kTimeouts)); },
     [](const std::string& value) -> std::string {
       return value == "0" ? "" : "the host watchdog has timed out " + value + " times since the reset";
     }},
    {"last reset", Needs::Nothing, false,
     [](Device& device, const Model& /*model*/) {
       return one_of(device.extension(kResetReason),
                     {"unknown", "power-on", "module watchdog", "software", "reset pin", "fault"});
     },
     [](const std::string& value) -> std::string {
       return value == "module watchdog" || value == "fault"
                  ? "the last reset came from the module itself: " + value
                  : "";
     }},
    {"seconds up", Needs::Nothing, false,
     [](Device& device, const Model& /*model*/) {
       return std::to_string(device.long_extension(kSecondsUp));
     }},
    {"stores", Needs::Nothing, false,
     [](Device& device, const Model& /*model*/) { return plain(device.extension(kStores)); }},
    {"settings from", Needs::Nothing, false,
     [](Device& device, const Model& /*model*/) {
       return one_of(device.extension(kSettingsSource),
                     {"a good copy", "a good copy beside a bad one", "the factory: no copy is good",
                      "an older layout", "the factory: the memory is blank"});
     },
     [](const std::string& value) -> std::string {
       return value.find("bad") != std::string::npos || value.find("no copy") != std::string::npos
                  ? "the memory of the settings had damage at the reset"
                  : "";
     }},
    {"line tallies", Needs::Nothing, false,
     [](Device& device, const Model& /*model*/) {
       sim::Words texts;
       for (unsigned i = 0; i < kLineTalliesCount; ++i) {
         texts.push_back(plain(device.extension(kLineTallies + i)));
       }
       return sim::joined(texts);
     }},
    {"update", Needs::Modbus, false,
     [](Device& device, const Model& /*model*/) {
       return one_of(device.extension(kUpdateState), {"none", "receiving", "complete", "activation pending",
                                                      "unconfirmed", "taken back", "flash failed"});
     },
     [](const std::string& value) -> std::string {
       return value == "unconfirmed"  ? "the firmware is new and has not proved itself: a reset takes it back"
              : value == "taken back" ? "a newer firmware did not prove itself and was taken back"
                                      : "";
     }},
};

}  // namespace ex9000::utility
