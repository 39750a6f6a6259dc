// The description of a module: MODEL[@ADDR][,KEY=VALUE]... on the command line, an object in a bus file.
#pragma once

#include <string>
#include <vector>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "sim/virtual_line/line/input_program.hpp"

namespace ex9000::sim {

/// A module of a line, as the command line or a bus file describes it.
struct ModuleSpec {
  const Model* model = nullptr;
  Settings settings;            ///< stored before power-on; an existing EEPROM file replaces them
  bool settings_given = false;  ///< at least one setting was given explicitly
  bool init_asserted = false;
  std::string eeprom;  ///< path of the EEPROM file; empty: settings are lost when the simulator ends
  std::string eeprom_place = "eeprom=";  ///< prefix of messages about the EEPROM file
  std::vector<InputProgram> inputs;      ///< programs that change inputs
};

/// Parses MODEL[@ADDR][,KEY=VALUE]... Throws std::invalid_argument with a one-line message that says what is
/// wrong and what would be right.
ModuleSpec parse_module_spec(const std::string& text);

// The steps of parse_module_spec. If a key or a value is wrong, they throw like parse_module_spec.

/// Returns a module of this model with factory settings.
ModuleSpec factory_fresh(const Model& model);
/// Sets the address. `text` is one or two hex digits.
void set_address(ModuleSpec& spec, const std::string& text);
/// Applies `value` of one of these keys: protocol, baud, format, checksum, edge, name, init or eeprom. The
/// command line and bus files use the same names for these keys.
void apply_setting(ModuleSpec& spec, const std::string& key, const std::string& value);
/// Checks that the address is a Modbus address if the protocol is Modbus RTU.
void check(const ModuleSpec& spec);

/// Returns the model with this designation, in upper or lower case, with or without EX. Throws like
/// parse_module_spec.
const Model& model_called(const std::string& name);
/// Throws the std::invalid_argument for `name`, which is not a model. The message has one line, and names the
/// models with similar names.
[[noreturn]] void refuse_model(const std::string& name);

}  // namespace ex9000::sim
