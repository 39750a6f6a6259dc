#include "sim/virtual_line/line/module_spec.hpp"

#include <algorithm>
#include <cctype>
#include <set>
#include <sstream>

#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"
#include "sim/virtual_line/line/named_settings.hpp"

namespace ex9000::sim {

const Model& model_called(const std::string& name) {
  std::string wanted = name;
  std::transform(name.begin(), name.end(), wanted.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  for (const std::string& designation : {wanted, "EX" + wanted}) {
    if (const Model* model = find_model(designation)) {
      return *model;
    }
  }
  fail("'" + name + "' is not a model; 'ex9000-sim --models' lists all models");
}

ModuleSpec factory_fresh(const Model& model) {
  ModuleSpec spec;
  spec.model = &model;
  spec.settings = Settings::factory(model);
  return spec;
}

void set_address(ModuleSpec& spec, const std::string& text) {
  spec.settings.address = parse_hex_byte(text);
  spec.settings_given = true;
}

void apply_setting(ModuleSpec& spec, const std::string& key, const std::string& value) {
  if (key == "eeprom") {
    if (value.empty()) {
      fail("is empty; name a path");
    }
    spec.eeprom = value;
  } else if (key == "init") {
    spec.init_asserted = parse_on_off(value);
  } else if (set_by_name(spec.settings, *spec.model, key, value)) {
    spec.settings_given = true;
  } else {
    fail("unknown key; expected one of protocol, baud, format, checksum, edge, name, init, eeprom");
  }
}

void check(const ModuleSpec& spec) {
  if (spec.settings.protocol == Protocol::ModbusRtu && !is_modbus_address(spec.settings.address)) {
    fail("address " + hex_byte_text(spec.settings.address) +
         ": is not a Modbus address; expected hex 01 to F7, or the protocol ascii");
  }
}

ModuleSpec parse_module_spec(const std::string& text) {
  return with_place((text.empty() ? "an empty argument" : text) + ": ", [&] {
    std::istringstream parts(text);
    std::string name;
    std::getline(parts, name, ',');
    const auto at = name.find('@');
    ModuleSpec spec = factory_fresh(model_called(name.substr(0, at)));
    if (at != std::string::npos) {
      with_place("address: ", [&] { set_address(spec, name.substr(at + 1)); });
    }
    std::set<std::string> keys;
    for (std::string option; std::getline(parts, option, ',');) {
      const auto equals = option.find('=');
      const std::string key = option.substr(0, equals);
      with_place(key + "=: ", [&] {
        if (!keys.insert(key).second) {
          fail("is given twice; leave out one of them");
        }
        apply_setting(spec, key, equals == std::string::npos ? "" : option.substr(equals + 1));
      });
    }
    if (text.back() == ',') {
      fail("ends with a comma; leave it out, or add KEY=VALUE");
    }
    check(spec);
    return spec;
  });
}

}  // namespace ex9000::sim
