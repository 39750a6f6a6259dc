#include "sim/utility/device/property.hpp"

#include <algorithm>
#include <functional>

#include "firmware/model/baud.hpp"
#include "sim/text/durations.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"
#include "sim/utility/device/channels.hpp"
#include "sim/utility/device/find.hpp"
#include "sim/utility/modbus/register_map.hpp"

namespace ex9000::utility {

namespace {

constexpr unsigned kSafeCoils = coils_of("safe-value");
constexpr unsigned kPowerOnCoils = coils_of("power-on-value");
constexpr unsigned kProtocolCoil = coils_of("protocol");
constexpr unsigned kWatchdogCoil = coils_of("watchdog-enable");
constexpr unsigned kEdgeCoil = coils_of("counting-edge");
constexpr unsigned kAddressRegister = registers_of("address");
constexpr unsigned kBaudCodeRegister = registers_of("baud-code");
constexpr unsigned kTimeoutRegister = registers_of("watchdog-timeout");
constexpr unsigned kFilterRegisters = registers_of("input-filters");
constexpr unsigned kInvertedRegister = registers_of("inverted-inputs");
constexpr unsigned kFeedRegister = registers_of("watchdog-feed");
constexpr unsigned kDelayRegister = registers_of("response-delay");
constexpr unsigned kUpdatesRegister = registers_of("updates-allowed");

// --- `%AANNTTCCFF` and `$AA2` (manuals 2.1, 2.5) ---

struct Configuration {
  std::uint8_t address;  ///< stored; not the one in force in INIT mode
  std::uint8_t baud_code;
  std::uint8_t format;
};

Configuration configuration_of(Device& device) {
  const std::string text = device.ask("$AA2", "!");  // AATTCCFF
  constexpr std::size_t kSize = 8;
  if (text.size() != kSize || text.find_first_not_of("0123456789ABCDEF") != std::string::npos) {
    throw Failed("replies '!" + text + "' to $AA2, not !AATTCCFF");
  }
  const auto byte = [&](std::size_t at) { return static_cast<std::uint8_t>(hex_number(text.substr(at, 2))); };
  const Configuration configuration{byte(0), byte(4), byte(6)};
  if (!is_baud_code(configuration.baud_code)) {
    throw Failed("has the unknown baud code " + text.substr(4, 2));
  }
  device.set_in_init(configuration.address != device.address());
  return configuration;
}

/// Whether the module answers at an address now.
bool answers_at(Device& device, std::uint8_t address) {
  constexpr unsigned kTries = 2;
  device.moves_to(address);
  for (unsigned i = 0; i < kTries; ++i) {
    if (device.line().dcon().ask("$" + sim::hex_byte_text(address) + "2")) {
      return true;
    }
  }
  return false;
}

/// A new address is in force at once, but not in INIT mode. If the reply is lost, who answers tells.
void configure(Device& device, Configuration configuration) {
  const std::uint8_t before = device.address();
  const std::string digits = sim::hex_byte_text(configuration.address);
  try {
    device.ask("%AA" + digits + "40" + sim::hex_byte_text(configuration.baud_code) +
                   sim::hex_byte_text(configuration.format),
               "!" + digits);
  } catch (const Absent&) {
    throw Failed("refuses to change rate, format or checksum; tie INIT* to GND and repeat the command");
  } catch (const Failed&) {
    if (configuration.address == before) {
      throw;
    }
  }
  if (configuration.address != before && !answers_at(device, configuration.address)) {
    device.moves_to(before);
  }
}

std::uint8_t baud_code_of(Device& device) {
  if (!device.speaks_modbus()) {
    return configuration_of(device).baud_code;
  }
  const unsigned code = device.read(read_words(kBaudCodeRegister, 1)).word(0);
  if (!is_baud_code(code)) {
    throw Failed("has the unknown baud code " + sim::hex_word_text(code));
  }
  return static_cast<std::uint8_t>(code);
}

void set_baud_code(Device& device, std::uint8_t code) {
  if (device.speaks_modbus()) {
    device.write(write_word(kBaudCodeRegister, code));
    return;
  }
  Configuration configuration = configuration_of(device);
  configuration.baud_code = code;
  configure(device, configuration);
}

bool format_bit(Device& device, std::uint8_t bit) { return (configuration_of(device).format & bit) != 0; }

void set_format_bit(Device& device, std::uint8_t bit, bool on) {
  Configuration configuration = configuration_of(device);
  configuration.format =
      static_cast<std::uint8_t>(on ? configuration.format | bit : configuration.format & ~bit);
  configure(device, configuration);
}

// --- coils ---

bool coil(Device& device, unsigned address) { return (device.read(read_bits(address, 1)).data[0] & 1U) != 0; }

std::uint16_t coils(Device& device, unsigned address, unsigned count) {
  const Data data = device.read(read_bits(address, count)).data;
  return static_cast<std::uint16_t>(data[0] | (data.size() > 1 ? data[1] << 8U : 0));
}

// --- outputs at the start ---

/// `First` and `Second` as bits of channels: manuals 2.20; `VV00` up to 8 outputs.
std::uint16_t output_bits(const std::string& digits, const Model& model) {
  constexpr std::size_t kSize = 4;
  constexpr unsigned kBits = 8;
  if (digits.size() != kSize) {
    throw Failed("replies '" + digits + "', not four hex digits");
  }
  return static_cast<std::uint16_t>(model.outputs > kBits ? hex_number(digits) : hex_number(digits) >> kBits);
}

/// `letter`: P or S.
std::uint16_t preset(Device& device, const Model& model, char letter) {
  if (device.speaks_modbus()) {
    return coils(device, letter == 'P' ? kPowerOnCoils : kSafeCoils, model.outputs);
  }
  return output_bits(device.ask(std::string("~AA4") + letter), model);
}

std::string bits_form(const std::string& value, std::uint16_t mask) {
  const std::uint16_t bits = sim::parse_hex_word(value);
  if ((bits & ~mask) != 0) {
    sim::fail("'" + value + "': expected bits of the channels, at most " + sim::hex_word_text(mask));
  }
  return sim::hex_word_text(bits);
}

std::string outputs_form(const Model& model, const std::string& value) {
  return bits_form(value, model.output_mask());
}

/// Drives the outputs: both protocols store only what the outputs have.
void set_preset(Device& device, const Model& model, char letter, const std::string& value) {
  const std::uint16_t bits = sim::parse_hex_word(value);
  if (!device.speaks_modbus()) {
    constexpr unsigned kMostInTwoDigits = 8;
    constexpr unsigned kMostInOneDigit = 4;
    const std::string all = sim::hex_word_text(bits);
    const std::size_t digits = model.outputs > kMostInTwoDigits ? 4 : model.outputs > kMostInOneDigit ? 2 : 1;
    device.ask("@AA" + all.substr(all.size() - digits), ">");
    device.ask(std::string("~AA5") + letter);
    return;
  }
  Data pdu{0x0F};
  append_word(pdu, letter == 'P' ? kPowerOnCoils : kSafeCoils);
  append_word(pdu, model.outputs);
  const Data reply = pdu;
  const bool two_bytes = model.outputs > 8;
  pdu.push_back(two_bytes ? 2 : 1);
  pdu.push_back(static_cast<std::uint8_t>(bits));
  if (two_bytes) {
    pdu.push_back(static_cast<std::uint8_t>(bits >> 8U));
  }
  try {
    device.write({pdu, reply, reply.size()});
  } catch (const Failed&) {
    if (has_timed_out(device)) {
      throw Failed("is refused, because the host watchdog has timed out; write 1 to coil 0x010D first");
    }
    throw;
  }
}

// --- host watchdog: `~AA2` reads EVV, `~AA3EVV` sets it (manuals 2.18, 2.19) ---

std::string watchdog(Device& device) {
  std::string text = device.ask("~AA2");
  if (text.size() != 3) {
    throw Failed("replies '" + text + "' to ~AA2, not EVV");
  }
  return text;
}

std::string timeout_text(unsigned tenths) { return sim::time_text(std::chrono::milliseconds(100) * tenths); }

unsigned parse_timeout(const std::string& value) {
  constexpr std::chrono::milliseconds kUnit{100};
  constexpr unsigned kMost = 255;
  const auto time = sim::parse_time(value);
  if (time % kUnit != Time(0) || time > kMost * kUnit) {
    sim::fail("'" + value + "': expected up to 25.5s, in steps of 0.1s");
  }
  return static_cast<unsigned>(time / kUnit);
}

// --- the table ---

/// One time if all are equal.
std::string filters_text(const sim::Words& times) {
  const bool all_equal = std::adjacent_find(times.begin(), times.end(), std::not_equal_to<>()) == times.end();
  return all_equal ? times.front() : sim::joined(times, ",");
}

std::string filters_form(const Model& model, const std::string& value) {
  sim::Words times;
  for (const std::string& part : sim::parts_of(value, ',')) {
    times.push_back(std::to_string(sim::parse_whole_number(part, 0, InputFilters::kLongest)));
  }
  if (times.size() != 1 && times.size() != model.inputs) {
    sim::fail("'" + value + "': expected one time for all inputs, or " + std::to_string(model.inputs) +
              " times");
  }
  return filters_text(times);
}

std::string filters(Device& device, const Model& model) {
  sim::Words times;
  for (unsigned channel = 0; channel < model.inputs; ++channel) {
    times.push_back(std::to_string(device.extension(kFilterRegisters + channel)));
  }
  return filters_text(times);
}

void set_filters(Device& device, const Model& model, const std::string& value) {
  const sim::Words times = sim::parts_of(value, ',');
  Data words;
  for (unsigned channel = 0; channel < model.inputs; ++channel) {
    const auto time = static_cast<unsigned>(std::stoul(times.size() == 1 ? times[0] : times[channel]));
    append_word(words, time);
    if (!device.speaks_modbus()) {
      device.write_extension(kFilterRegisters + channel, time);
    }
  }
  if (device.speaks_modbus()) {
    device.write(write_words(kFilterRegisters, {words.data(), words.size()}));
  }
}

std::string address_form(const Model& /*model*/, const std::string& value) {
  return std::to_string(parse_address(value));
}

void set_address(Device& device, const Model& /*model*/, const std::string& value) {
  const std::uint8_t address = parse_address(value);
  if (device.speaks_modbus()) {
    device.write(write_word(kAddressRegister, address));
    return;
  }
  Configuration configuration = configuration_of(device);
  configuration.address = address;
  configure(device, configuration);
}

std::string name_form(const Model& model, const std::string& value) {
  if (!Name(std::string_view(value)).is_possible(model.longest_name) || value.size() > model.longest_name) {
    sim::fail("'" + value + "': expected 1 to " + std::to_string(model.longest_name) +
              " printable ASCII characters");
  }
  return value;
}

std::string on_off_form(const Model& /*model*/, const std::string& value) {
  return sim::on_off_text(sim::parse_on_off(value));
}

}  // namespace

const std::vector<Property> properties{
    {"protocol", "ascii|modbus", "the protocol", Needs::Modbus,
     [](const Model& /*model*/, const std::string& value) -> std::string {
       return sim::parse_choice(value, "modbus", "ascii") ? "modbus" : "ascii";
     },
     [](Device& device, const Model& /*model*/) -> std::string {
       const bool modbus = device.speaks_modbus() ? coil(device, kProtocolCoil) : device.ask("$AAP") == "11";
       return modbus ? "modbus" : "ascii";
     },
     [](Device& device, const Model& /*model*/, const std::string& value) {
       if (device.speaks_modbus()) {
         device.write(write_bit(kProtocolCoil, value == "modbus"));
         return;
       }
       try {
         device.ask(value == "modbus" ? "$AAP1" : "$AAP0");
       } catch (const Absent&) {
         throw Failed("refuses to change the protocol; tie INIT* to GND and repeat the command");
       }
     },
     InForce::AtReset},
    {"baud", "1200|2400|4800|9600|19200|38400|57600|115200", "the baud rate", Needs::Nothing,
     [](const Model& /*model*/, const std::string& value) {
       return std::to_string(sim::parse_baud_rate(value));
     },
     [](Device& device, const Model& /*model*/) { return std::to_string(baud_rate(baud_code_of(device))); },
     [](Device& device, const Model& /*model*/, const std::string& value) {
       const auto* const rate = std::find(kBaudRates.begin(), kBaudRates.end(), sim::parse_baud_rate(value));
       set_baud_code(device,
                     with_line_format(static_cast<std::uint8_t>(kFirstBaudCode + (rate - kBaudRates.begin())),
                                      line_format(baud_code_of(device))));
     },
     InForce::AtReset},
    {"format", "8N1|8N2|8E1|8O1", "the line format", Needs::Nothing,
     [](const Model& /*model*/, const std::string& value) {
       return sim::line_format_text(sim::parse_line_format(value));
     },
     [](Device& device, const Model& /*model*/) {
       return sim::line_format_text(line_format(baud_code_of(device)));
     },
     [](Device& device, const Model& /*model*/, const std::string& value) {
       set_baud_code(device, with_line_format(baud_code_of(device), sim::parse_line_format(value)));
     },
     InForce::AtReset},
    {"checksum", "on|off", "the checksum of ASCII frames", Needs::Nothing, on_off_form,
     [](Device& device, const Model& /*model*/) {
       if (device.speaks_modbus()) {
         throw Absent("tells this only in ASCII");
       }
       return sim::on_off_text(format_bit(device, kFormatChecksum));
     },
     [](Device& device, const Model& /*model*/, const std::string& value) {
       set_format_bit(device, kFormatChecksum, value == "on");
     },
     InForce::AtReset, "", true},
    {"updates-allowed", "on|off", "whether the firmware can be updated over the line", Needs::Modbus,
     on_off_form,
     [](Device& device, const Model& /*model*/) {
       return sim::on_off_text(device.extension(kUpdatesRegister) != 0);
     },
     [](Device& device, const Model& /*model*/, const std::string& value) {
       try {
         device.write_extension(kUpdatesRegister, value == "on" ? 1 : 0);
       } catch (const Failed&) {
         throw Failed("refuses to change this; tie INIT* to GND and repeat the command");
       }
     }},
    {"name", "TEXT", "the name that $AAM reads", Needs::Nothing, name_form,
     [](Device& device, const Model& /*model*/) {
       return device.speaks_modbus() ? name_in_modbus(device) : device.ask("$AAM");
     },
     [](Device& device, const Model& /*model*/, const std::string& value) { device.ask("~AAO" + value); },
     InForce::Now, "", true},
    {"edge", "falling|rising", "the edge that the counters count", Needs::Inputs,
     [](const Model& /*model*/, const std::string& value) -> std::string {
       return sim::parse_choice(value, "rising", "falling") ? "rising" : "falling";
     },
     [](Device& device, const Model& /*model*/) -> std::string {
       const bool rising =
           device.speaks_modbus() ? coil(device, kEdgeCoil) : format_bit(device, kFormatRisingEdge);
       return rising ? "rising" : "falling";
     },
     [](Device& device, const Model& /*model*/, const std::string& value) {
       if (device.speaks_modbus()) {
         device.write(write_bit(kEdgeCoil, value == "rising"));
       } else {
         set_format_bit(device, kFormatRisingEdge, value == "rising");
       }
     },
     InForce::AtResetAscii},
    {"input-filters", "MS[,MS...]", "filter of the inputs in ms, for all or for each, 0 to 2000",
     Needs::Inputs, filters_form, filters, set_filters},
    {"inverted-inputs", "HHHH", "inverted inputs; bit n is input n", Needs::Inputs,
     [](const Model& model, const std::string& value) { return bits_form(value, model.input_mask()); },
     [](Device& device, const Model& /*model*/) {
       return sim::hex_word_text(device.extension(kInvertedRegister));
     },
     [](Device& device, const Model& /*model*/, const std::string& value) {
       device.write_extension(kInvertedRegister, hex_number(value));
     }},
    {"power-on-value", "HHHH", "the outputs from a reset on; bit n is output n", Needs::Outputs, outputs_form,
     [](Device& device, const Model& model) { return sim::hex_word_text(preset(device, model, 'P')); },
     [](Device& device, const Model& model, const std::string& value) {
       set_preset(device, model, 'P', value);
     },
     InForce::Now, "also switches the outputs to this value now"},
    {"safe-value", "HHHH", "the outputs after a timeout of the host watchdog; bit n is output n",
     Needs::Outputs, outputs_form,
     [](Device& device, const Model& model) { return sim::hex_word_text(preset(device, model, 'S')); },
     [](Device& device, const Model& model, const std::string& value) {
       set_preset(device, model, 'S', value);
     },
     InForce::Now, "also switches the outputs to this value now"},
    {"watchdog-timeout", "TIME", "the time of the host watchdog, up to 25.5s", Needs::Nothing,
     [](const Model& /*model*/, const std::string& value) { return timeout_text(parse_timeout(value)); },
     [](Device& device, const Model& /*model*/) {
       return timeout_text(device.speaks_modbus() ? device.read(read_words(kTimeoutRegister, 1)).word(0)
                                                  : hex_number(watchdog(device).substr(1)));
     },
     [](Device& device, const Model& /*model*/, const std::string& value) {
       const unsigned tenths = parse_timeout(value);
       if (device.speaks_modbus()) {
         device.write(write_word(kTimeoutRegister, static_cast<std::uint16_t>(tenths)));
       } else {
         device.ask("~AA3" + watchdog(device).substr(0, 1) + sim::hex_byte_text(tenths));
       }
     }},
    {"watchdog-feed", "host-ok|requests", "what restarts the host watchdog", Needs::Nothing,
     [](const Model& /*model*/, const std::string& value) -> std::string {
       return sim::parse_choice(value, "requests", "host-ok") ? "requests" : "host-ok";
     },
     [](Device& device, const Model& /*model*/) -> std::string {
       return device.extension(kFeedRegister) == 0 ? "host-ok" : "requests";
     },
     [](Device& device, const Model& /*model*/, const std::string& value) {
       device.write_extension(kFeedRegister, value == "requests" ? 1 : 0);
     }},
    {"response-delay", "MS", "response delay in ms, 0 to 30", Needs::Nothing,
     [](const Model& /*model*/, const std::string& value) {
       return std::to_string(sim::parse_whole_number(value, 0, kLongestResponseDelay));
     },
     [](Device& device, const Model& /*model*/) { return std::to_string(device.extension(kDelayRegister)); },
     [](Device& device, const Model& /*model*/, const std::string& value) {
       device.write_extension(kDelayRegister, static_cast<unsigned>(std::stoul(value)));
     }},
    {"address", "N", "the address", Needs::Nothing, address_form,
     [](Device& device, const Model& /*model*/) {
       return device.speaks_modbus() ? std::to_string(device.read(read_words(kAddressRegister, 1)).word(0))
                                     : std::to_string(configuration_of(device).address);
     },
     set_address, InForce::AtResetModbus},
    {"watchdog", "on|off", "the host watchdog", Needs::Nothing, on_off_form,
     [](Device& device, const Model& /*model*/) {
       return sim::on_off_text(device.speaks_modbus() ? coil(device, kWatchdogCoil)
                                                      : watchdog(device)[0] == '1');
     },
     [](Device& device, const Model& /*model*/, const std::string& value) {
       if (device.speaks_modbus()) {
         device.write(write_bit(kWatchdogCoil, value == "on"));
       } else {
         device.ask(std::string("~AA3") + (value == "on" ? "1" : "0") + watchdog(device).substr(1));
       }
     }},
};

bool needs_reset(const Property& property, const Device& device) {
  return property.in_force == InForce::AtReset ||
         property.in_force == (device.speaks_modbus() ? InForce::AtResetModbus : InForce::AtResetAscii) ||
         (property.in_force != InForce::Now && device.in_init());
}

const Property& property_called(const std::string& key) {
  const auto found = std::find_if(properties.begin(), properties.end(),
                                  [&](const Property& property) { return property.key == key; });
  if (found == properties.end()) {
    sim::Words keys;
    for (const Property& property : properties) {
      keys.emplace_back(property.key);
    }
    sim::fail("'" + key + "': expected one of " + sim::joined(keys, ", "));
  }
  return *found;
}

}  // namespace ex9000::utility
