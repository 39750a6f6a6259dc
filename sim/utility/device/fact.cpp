#include "sim/utility/device/fact.hpp"

#include <algorithm>
#include <limits>

#include "firmware/update/update.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"

namespace ex9000::utility {

namespace {

constexpr unsigned kBitsOfAByte = 8;

// Coils and registers: firmware/registers/.
constexpr unsigned kOutputCoils = 0x0000;
constexpr unsigned kInputCoils = 0x0020;
constexpr unsigned kLatchHighCoils = 0x0040;
constexpr unsigned kLatchLowCoils = 0x0060;
constexpr unsigned kTimeoutCoil = 0x010D;
constexpr unsigned kCounters = 0x0000;
constexpr unsigned kResetReason = 0x0301;
constexpr unsigned kSecondsUp = 0x0302;
constexpr unsigned kTimeouts = 0x0304;
constexpr unsigned kStores = 0x0305;
constexpr unsigned kSettingsSource = 0x0306;
constexpr unsigned kLineTallies = 0x0308;
constexpr unsigned kLineTalliesCount = 8;
constexpr unsigned kUpdateState = 0x1010;

std::string bits_text(unsigned bits, unsigned channels) {
  std::string text = sim::hex_word_text(bits);
  return channels > kBitsOfAByte ? text : text.substr(2);
}

/// `First` and `Second` (wire.md section 1): on a model with inputs and outputs these are outputs and inputs.
/// Else the channels of the one kind: with more than 8, the high ones first.
std::string channels_of(const std::string& digits, const Model& model, bool inputs) {
  constexpr std::size_t kLeast = 4;
  if (digits.size() < kLeast) {
    throw Failed("replies '" + digits + "', not four hex digits");
  }
  const std::string first = digits.substr(0, 2);
  const std::string second = digits.substr(2, 2);
  if (model.has_inputs() && model.has_outputs()) {
    return inputs ? second : first;
  }
  return std::max(model.inputs, model.outputs) > kBitsOfAByte ? first + second : first;
}

std::string bits(Device& device, unsigned address, unsigned count) {
  const Data data = device.read(read_bits(address, count)).data;
  return bits_text(data[0] | (data.size() > 1 ? unsigned{data[1]} << kBitsOfAByte : 0U), count);
}

std::string inputs(Device& device, const Model& model) {
  return device.speaks_modbus() ? bits(device, kInputCoils, model.inputs)
                                : channels_of(device.ask("@AA", ">"), model, true);
}

std::string outputs(Device& device, const Model& model) {
  return device.speaks_modbus() ? bits(device, kOutputCoils, model.outputs)
                                : channels_of(device.ask("@AA", ">"), model, false);
}

std::string latches(Device& device, const Model& model, bool high) {
  return device.speaks_modbus() ? bits(device, high ? kLatchHighCoils : kLatchLowCoils, model.inputs)
                                : channels_of(device.ask(high ? "$AAL1" : "$AAL0", "!"), model, true);
}

std::string counters(Device& device, const Model& model) {
  constexpr std::string_view kDigits = "0123456789ABCDEF";
  sim::Words texts;
  if (device.speaks_modbus()) {
    const Answer answer = device.read(read_words(kCounters, model.inputs));
    for (unsigned channel = 0; channel < model.inputs; ++channel) {
      texts.push_back(std::to_string(answer.word(channel)));
    }
  } else {
    for (unsigned channel = 0; channel < model.inputs; ++channel) {
      const std::string digits = device.ask(std::string("#AA") + kDigits[channel]);
      const auto count = sim::whole_number(digits, std::numeric_limits<std::uint32_t>::max());
      if (!count) {
        throw Failed("replies '" + digits + "' where a counter is expected");
      }
      texts.push_back(std::to_string(*count));
    }
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
  constexpr const char* kWithTimeout[] = {"04", "84"};
  const std::string status = device.speaks_modbus() ? "" : device.ask("~AA0");
  const bool set = device.speaks_modbus() ? (device.read(read_bits(kTimeoutCoil, 1)).data[0] & 1U) != 0
                                          : std::find(std::begin(kWithTimeout), std::end(kWithTimeout),
                                                      status) != std::end(kWithTimeout);
  return set ? "set" : "clear";
}

std::string plain(unsigned value) { return std::to_string(value); }

std::string one_of(unsigned value, const sim::Words& texts) {
  return value < texts.size() ? texts[value] : std::to_string(value);
}

}  // namespace

const std::vector<Fact> facts{
    {"outputs", Needs::Outputs, true, outputs},
    {"inputs", Needs::Inputs, true, inputs},
    {"latch high", Needs::Inputs, true,
     [](Device& device, const Model& model) { return latches(device, model, true); }},
    {"latch low", Needs::Inputs, true,
     [](Device& device, const Model& model) { return latches(device, model, false); }},
    {"counters", Needs::Inputs, true, counters, near_their_end},
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
