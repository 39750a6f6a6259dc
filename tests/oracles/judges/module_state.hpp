// Converts the state of the firmware to the types that a Witness receives.
#pragma once

#include <cstdint>

#include "firmware/model/baud.hpp"
#include "firmware/request/state.hpp"
#include "tests/oracles/judges/demand.hpp"
#include "tests/oracles/judges/witness.hpp"

namespace ex9000::judges {

/// Returns the values of the module. `outputs`: the levels at the pins.
inline Values values_of(const State& state, std::uint16_t outputs) {
  const Settings& settings = state.settings;
  return {outputs,
          settings.power_on_value,
          settings.safe_value,
          settings.watchdog_timeout,
          settings.watchdog_enabled,
          settings.timeout_status,
          state.output_timers.running()};
}

inline Listening listening_of(const State& state) {
  const InForce& now = state.in_force;
  Listening listening;
  listening.modbus = now.protocol == Protocol::ModbusRtu;
  listening.address = now.address;
  listening.baud = baud_rate(now.baud_code);
  listening.format = line_format(now.baud_code);
  listening.checksum = now.checksum;
  listening.init_mode = now.init_mode;
  listening.delays = state.settings.response_delay != 0;
  return listening;
}

}  // namespace ex9000::judges
