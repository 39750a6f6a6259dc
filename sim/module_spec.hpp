// What the command line says of one module: MODEL[@ADDR][,KEY=VALUE]...
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "sim/input_program.hpp"

namespace ex9000::sim {

/// A module of a line, as a command line or a bus file has it.
struct ModuleSpec {
  const Model* model = nullptr;
  Settings settings;            ///< stored before power-on, unless the EEPROM's file has others
  bool settings_given = false;  ///< they are not just the factory's
  bool init_asserted = false;
  std::string eeprom;  ///< path of the EEPROM's file; empty: what is stored lasts as long as the program
  std::vector<InputProgram> inputs;  ///< those that move by themselves
};

/// Throws std::invalid_argument, one line that names what is wrong and what would be right.
ModuleSpec parse_module_spec(const std::string& text);

// The same one by one; they throw likewise.

ModuleSpec factory_fresh(const Model& model);
/// One or two hex digits.
void set_address(ModuleSpec& spec, const std::string& text);
/// What a KEY=VALUE of the command line says.
void apply_setting(ModuleSpec& spec, const std::string& key, const std::string& value);
/// What is right of each alone, and not of all.
void check(const ModuleSpec& spec);

/// The model of this designation, in any case, with or without EX. Throws like parse_module_spec.
const Model& model_called(const std::string& name);

/// Of one or two hex digits, in any case; nothing where it is something else.
std::optional<std::uint8_t> hex_byte_of(const std::string& text);

/// Two upper-case digits.
std::string hex_byte_text(unsigned value);
/// Likewise, four digits of the lowest 16 bits.
std::string hex_word_text(unsigned value);

}  // namespace ex9000::sim
