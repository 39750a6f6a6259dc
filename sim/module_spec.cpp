#include "sim/module_spec.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <sstream>
#include <stdexcept>

#include "firmware/hex.hpp"
#include "firmware/model/baud.hpp"
#include "sim/fail.hpp"

namespace ex9000::sim {

namespace {

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  return text;
}

std::uint8_t parse_address(const std::string& text) {
  const std::optional<std::uint8_t> address = hex_byte_of(text);
  if (!address) {
    fail("address '" + text + "' is not one or two hex digits, 00 to FF");
  }
  return *address;
}

bool parse_choice(const std::string& key, const std::string& value, const char* yes, const char* no) {
  if (value != yes && value != no) {
    fail("'" + key + "=" + value + "' wants " + yes + " or " + no);
  }
  return value == yes;
}

std::uint8_t parse_baud(const std::string& value) {
  for (std::uint8_t code = kFirstBaudCode; code <= kLastBaudCode; ++code) {
    if (value == std::to_string(baud_rate(code))) {
      return code;
    }
  }
  fail("'baud=" + value + "' wants 1200, 2400, 4800, 9600, 19200, 38400, 57600 or 115200");
}

Name parse_name(const Model& model, const std::string& value) {
  const bool characters = std::all_of(value.begin(), value.end(), [](char c) {
    return Name::is_name_character(static_cast<std::uint8_t>(c));
  });
  if (value.empty() || value.size() > model.longest_name || !characters) {
    fail("'name=" + value + "' wants 1 to " + std::to_string(model.longest_name) +
         " printable ASCII characters on the " + std::string(model.designation));
  }
  return Name(std::string_view(value));
}

void set_format(Settings& settings, std::uint8_t bit, bool on) {
  settings.format = static_cast<std::uint8_t>(on ? settings.format | bit : settings.format & ~bit);
}

}  // namespace

const Model& model_called(const std::string& name) {
  const std::string wanted = upper(name);
  const Model* model = find_model(wanted);
  if (model == nullptr) {
    model = find_model("EX" + wanted);
  }
  if (model == nullptr) {
    fail("'" + name + "' is no model; --models lists them");
  }
  return *model;
}

std::optional<std::uint8_t> hex_byte_of(const std::string& text) {
  const std::string digits = upper(text.size() == 1 ? "0" + text : text);
  const int value = digits.size() == 2
                        ? hex_byte(static_cast<std::uint8_t>(digits[0]), static_cast<std::uint8_t>(digits[1]))
                        : -1;
  return value < 0 ? std::nullopt : std::optional(static_cast<std::uint8_t>(value));
}

std::string hex_byte_text(unsigned value) {
  return {static_cast<char>(hex_digit(value >> 4U)), static_cast<char>(hex_digit(value))};
}

std::string hex_word_text(unsigned value) {
  return hex_byte_text(value >> 8U & 0xFFU) + hex_byte_text(value & 0xFFU);
}

ModuleSpec factory_fresh(const Model& model) {
  ModuleSpec spec;
  spec.model = &model;
  spec.settings = Settings::factory(model);
  return spec;
}

void set_address(ModuleSpec& spec, const std::string& text) {
  spec.settings.address = parse_address(text);
  spec.settings_given = true;
}

void apply_setting(ModuleSpec& spec, const std::string& key, const std::string& value) {
  Settings& settings = spec.settings;
  if (key == "eeprom") {
    if (value.empty()) {
      fail("'eeprom=' wants a path");
    }
    spec.eeprom = value;
    return;
  }
  if (key == "init") {
    spec.init_asserted = parse_choice(key, value, "on", "off");
    return;
  }
  spec.settings_given = true;
  if (key == "protocol") {
    const bool modbus = parse_choice(key, value, "modbus", "ascii");
    if (modbus && !spec.model->speaks_modbus()) {
      fail("'protocol=modbus': the " + std::string(spec.model->designation) + " speaks ASCII only");
    }
    settings.protocol = modbus ? Protocol::ModbusRtu : Protocol::Ascii;
  } else if (key == "baud") {
    settings.baud_code = parse_baud(value);
  } else if (key == "checksum") {
    set_format(settings, kFormatChecksum, parse_choice(key, value, "on", "off"));
  } else if (key == "edge") {
    set_format(settings, kFormatRisingEdge, parse_choice(key, value, "rising", "falling"));
  } else if (key == "name") {
    settings.name = parse_name(*spec.model, value);
  } else {
    fail("'" + key +
         "=' is no setting; there are protocol=, baud=, checksum=, edge=, name=, init= and eeprom=");
  }
}

void check(const ModuleSpec& spec) {
  if (spec.settings.protocol == Protocol::ModbusRtu && !is_modbus_address(spec.settings.address)) {
    fail("address " + hex_byte_text(spec.settings.address) +
         " is none of Modbus, which has 01 to F7; or add protocol=ascii");
  }
}

ModuleSpec parse_module_spec(const std::string& text) {
  try {
    std::istringstream parts(text);
    std::string name;
    std::getline(parts, name, ',');
    const auto at = name.find('@');
    ModuleSpec spec = factory_fresh(model_called(name.substr(0, at)));
    if (at != std::string::npos) {
      set_address(spec, name.substr(at + 1));
    }
    std::set<std::string> keys;
    for (std::string option; std::getline(parts, option, ',');) {
      const auto equals = option.find('=');
      const std::string key = option.substr(0, equals);
      if (!keys.insert(key).second) {
        fail("'" + key + "=' is given twice");
      }
      apply_setting(spec, key, equals == std::string::npos ? "" : option.substr(equals + 1));
    }
    if (text.back() == ',') {
      fail("nothing behind the last comma");
    }
    check(spec);
    return spec;
  } catch (const std::invalid_argument& error) {
    fail((text.empty() ? "an empty argument" : text) + ": " + error.what());
  }
}

}  // namespace ex9000::sim
