// A module of a line, as the command line or a bus file describes it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "sim/text/places.hpp"
#include "sim/virtual_line/faults/fault.hpp"
#include "sim/virtual_line/line/input_program.hpp"

namespace ex9000::sim {

struct ModuleSpec {
  const Model* model = nullptr;
  Settings settings;            ///< stored before power-on; an existing EEPROM file replaces them
  bool settings_given = false;  ///< at least one setting was given explicitly
  bool init_asserted = false;
  std::uint32_t serial_number = 0;  ///< of the board; 0: from line and position, or none without a setup
  std::optional<VirtualTime> skew;  ///< of its windows in an arbitration; none: a few us
  std::string eeprom;  ///< path of the EEPROM file; empty: settings are lost when the simulator ends
  std::vector<InputProgram> inputs;
  std::vector<Fault> faults;
  Places places;
};

}  // namespace ex9000::sim
