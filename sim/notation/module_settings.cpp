#include "sim/notation/module_settings.hpp"

#include <algorithm>
#include <string_view>

#include "firmware/model/baud.hpp"
#include "sim/notation/fault_notation.hpp"
#include "sim/notation/input_notation.hpp"
#include "sim/text/durations.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

Protocol parse_protocol(const Model& model, const std::string& value) {
  if (!parse_choice(value, "modbus", "ascii")) {
    return Protocol::Ascii;
  }
  if (!model.speaks_modbus()) {
    fail("'modbus': the " + std::string(model.designation) + " speaks ASCII only; expected ascii");
  }
  return Protocol::ModbusRtu;
}

std::uint8_t with_rate(std::uint8_t baud_code, std::uint32_t rate) {
  const auto* const found = std::find(kBaudRates.begin(), kBaudRates.end(), rate);
  const auto code = static_cast<std::uint8_t>(kFirstBaudCode + (found - kBaudRates.begin()));
  return with_line_format(code, line_format(baud_code));
}

Name parse_name(const Model& model, const std::string& value) {
  const Name name{std::string_view(value)};
  if (value.size() > model.longest_name || !name.is_possible(model.longest_name)) {
    fail("'" + value + "': expected 1 to " + std::to_string(model.longest_name) +
         " printable ASCII characters for the " + std::string(model.designation));
  }
  return name;
}

void set_format(Settings& settings, std::uint8_t bit, bool on) {
  settings.format = static_cast<std::uint8_t>(on ? settings.format | bit : settings.format & ~bit);
}

/// Marks the settings as given by the user.
Settings& given(ModuleSpec& spec) {
  spec.settings_given = true;
  return spec.settings;
}

}  // namespace

const std::vector<Setting<ModuleSpec>> module_settings{
    {"address", Form::Text, "HH", "the address in hex, as in $AA2 (default: 01)",
     [](ModuleSpec& spec, const std::string& value) { given(spec).address = parse_hex_byte(value); }},
    {"protocol", Form::Choice, "ascii|modbus", "the protocol (default: modbus for -M models, else ascii)",
     [](ModuleSpec& spec, const std::string& value) {
       given(spec).protocol = parse_protocol(*spec.model, value);
     }},
    {"baud", Form::Choice, "1200|2400|4800|9600|19200|38400|57600|115200", "the baud rate (default: 9600)",
     [](ModuleSpec& spec, const std::string& value) {
       given(spec).baud_code = with_rate(spec.settings.baud_code, parse_baud_rate(value));
     }},
    {"format", Form::Choice, "8N1|8N2|8E1|8O1", "the line format (default: 8N1)",
     [](ModuleSpec& spec, const std::string& value) {
       given(spec).baud_code = with_line_format(spec.settings.baud_code, parse_line_format(value));
     }},
    {"checksum", Form::Flag, "on|off", "the checksum of ASCII frames (default: off)",
     [](ModuleSpec& spec, const std::string& value) {
       set_format(given(spec), kFormatChecksum, parse_on_off(value));
     }},
    {"edge", Form::Choice, "falling|rising", "the edge that the counters count (default: falling)",
     [](ModuleSpec& spec, const std::string& value) {
       set_format(given(spec), kFormatRisingEdge, parse_choice(value, "rising", "falling"));
     }},
    {"name", Form::Text, "TEXT", "the name that $AAM reads (default: the model's)",
     [](ModuleSpec& spec, const std::string& value) { given(spec).name = parse_name(*spec.model, value); }},
    {"serial", Form::Text, "HHHH",
     "the low word of the board's serial number (default: from line and position)",
     [](ModuleSpec& spec, const std::string& value) {
       spec.serial_number = serial_number_of(parse_hex_word(value));
     }},
    {"skew", Form::Text, "TIME",
     "how much later than other modules it begins a window of a bus scan (default: 0 to 4 us)",
     [](ModuleSpec& spec, const std::string& value) { spec.skew = parse_time(value); }},
    {"init", Form::Flag, "on|off", "on ties INIT* to GND: ASCII at address 00, 9600 baud (default: off)",
     [](ModuleSpec& spec, const std::string& value) { spec.init_asserted = parse_on_off(value); }},
    {"eeprom", Form::Text, "FILE",
     "keeps the settings in this file; an existing file overrides all settings above but init",
     [](ModuleSpec& spec, const std::string& value) {
       if (value.empty()) {
         fail("is empty; name a path");
       }
       spec.eeprom = value;
     }},
    {"input", Form::List, "INPUT",
     "an input that changes by itself, for example '0 square 100ms'; see 'help inputs'",
     [](ModuleSpec& spec, const std::string& value) {
       spec.inputs.push_back(parse_input_program(value, *spec.model));
     }},
    {"fault", Form::List, "FAULT",
     "a fault of this module, for example 'lost-reply every 10th reply'; see 'help faults'",
     [](ModuleSpec& spec, const std::string& value) {
       spec.faults.push_back(parse_fault(value, 0));  // the line sets the position
     }},
};

}  // namespace ex9000::sim
