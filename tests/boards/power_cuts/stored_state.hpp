// What an EEPROM holds before a command that stores.
#pragma once

#include <cstdint>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "tests/boards/power_cuts/cut_bench.hpp"
#include "tests/support/storing_commands.hpp"

namespace ex9000::registers {

enum class Beginning : std::uint8_t { Factory, Full };

struct State {
  Settings settings;
  Contents contents;
};

/// A state from which `command` stores something. A module from the factory has a blank EEPROM, unless the
/// command wants something else; one that is set up has both copies, the later with the last number before
/// they begin anew, and nothing in it is as it comes from the factory.
State begin_at(Beginning beginning, const Model& model, const StoringCommand& command);

/// What a module has to come up with, read by other code than its own.
Settings settings_in(const Model& model, const Contents& contents);

/// wire.md 2: the outputs of a module that has come up.
std::uint16_t outputs_from_reset(const Settings& settings);

}  // namespace ex9000::registers
