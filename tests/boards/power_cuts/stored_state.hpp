// What an EEPROM holds before a command that stores.
#pragma once

#include <cstdint>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "tests/boards/power_cuts/cut_bench.hpp"
#include "tests/support/storing_commands.hpp"

namespace ex9000::registers {

enum class Beginning : std::uint8_t {
  Factory,  ///< blank
  Full,     ///< both copies
  Updated,  ///< two copies of layout 2, as firmware before layout 3 leaves them
  Longer,   ///< the record that counts is one of newer firmware, with 96 bytes of settings
};

struct State {
  Settings settings;
  Contents contents;
};

/// A state from which `command` stores something. A module from the factory has a blank EEPROM, unless the
/// command requires something else. In all other states the later copy has the last number before they begin
/// anew, and none of its settings is as it comes from the factory.
State begin_at(Beginning beginning, const Model& model, const StoringCommand& command);

/// What a module has to come up with, read by other code than its own.
Settings settings_in(const Model& model, const Contents& contents);

/// wire.md 2: the outputs of a module that has come up.
std::uint16_t outputs_from_reset(const Settings& settings);

}  // namespace ex9000::registers
