// The contents of an EEPROM before a command that stores.
#pragma once

#include <cstdint>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "tests/boards/power_cuts/cut_bench.hpp"
#include "tests/support/storing_commands.hpp"

namespace ex9000::registers {

enum class Beginning : std::uint8_t {
  Factory,  ///< blank
  Full,     ///< both copies are in use
  Updated,  ///< two copies of layout 2, written by firmware before layout 3
  Longer,   ///< the newest record comes from newer firmware, with 96 bytes of settings
};

struct State {
  Settings settings;
  Contents contents;
};

/// Returns a state from which `command` stores something. In the factory state the EEPROM is blank, unless
/// the command requires other settings. In all other states the newer copy has the last sequence number
/// before the wrap, and the settings that the manuals describe differ from the factory settings as far as the
/// model and the command permit.
State begin_at(Beginning beginning, const Model& model, const StoringCommand& command);

/// Returns the settings with which a module must start. The code is independent of the firmware.
Settings settings_in(const Model& model, const Contents& contents);

/// Returns the outputs of a module after its start (wire.md section 2).
std::uint16_t outputs_from_reset(const Settings& settings);

}  // namespace ex9000::registers
