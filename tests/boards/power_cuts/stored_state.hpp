// The contents of an EEPROM before a command that stores, and the state of a module that starts from given
// contents.
#pragma once

#include <cstdint>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "tests/boards/power_cuts/cut_bench.hpp"
#include "tests/support/storing_commands.hpp"

namespace ex9000::registers {

enum class Beginning : std::uint8_t {
  Factory,  ///< blank, unless the command requires other settings
  Full,     ///< two copies
  Longer,   ///< as Full, but the newer record has 96 bytes of settings, like a record of newer firmware
};

struct State {
  Settings settings;
  Contents contents;
};

/// Returns a state from which `command` stores something. In all states except Factory, the newer copy has
/// the last sequence number before the wrap, and the settings that the manuals describe differ from the
/// factory settings as far as the model and the command permit.
State begin_at(Beginning beginning, const Model& model, const StoringCommand& command);

/// Returns the settings with which a module must start. Reads them with StoredCopy, which
/// shares no code with the firmware. If there is no good copy, returns the factory settings.
Settings settings_in(const Model& model, const Contents& contents);

/// Returns the outputs of a module after its start (wire.md section 2).
std::uint16_t outputs_from_reset(const Settings& settings);

}  // namespace ex9000::registers
