// The read and write functions of the coils and discrete inputs.
#include "firmware/modbus/registers.hpp"

namespace ex9000::modbus {

std::uint16_t read_outputs(const State& state) { return state.outputs; }

Refusal write_outputs(const State& /*state*/, BitWrite bits, Outcome& outcome) {
  outcome.drive(bits);
  return Refusal::None;
}

Refusal write_safe_value(const State& state, BitWrite bits, Outcome& outcome) {
  outcome.change().safe_value = bits.applied_to(state.settings.safe_value);
  return write_outputs(state, bits, outcome);
}

Refusal write_power_on_value(const State& state, BitWrite bits, Outcome& outcome) {
  outcome.change().power_on_value = bits.applied_to(state.settings.power_on_value);
  return write_outputs(state, bits, outcome);
}

std::uint16_t read_inputs(const State& state) { return state.inputs.levels(); }
std::uint16_t read_latch_high(const State& state) { return state.inputs.latched_high(); }
std::uint16_t read_latch_low(const State& state) { return state.inputs.latched_low(); }

Refusal write_protocol(const State& /*state*/, BitWrite bits, Outcome& outcome) {
  outcome.change().protocol = bits.value != 0 ? Protocol::ModbusRtu : Protocol::Ascii;
  return Refusal::None;
}

Refusal write_watchdog_enable(const State& /*state*/, BitWrite bits, Outcome& outcome) {
  const bool enable = bits.value != 0;
  outcome.change().watchdog_enabled = enable;
  if (enable) {
    outcome.request(Effect::RestartHostWatchdog);
  }
  return Refusal::None;
}

Refusal write_clear_latches(const State& /*state*/, BitWrite /*bits*/, Outcome& outcome) {
  outcome.request(Effect::ClearLatches);
  return Refusal::None;
}

Refusal write_clear_timeout_status(const State& /*state*/, BitWrite /*bits*/, Outcome& outcome) {
  outcome.change().timeout_status = false;
  return Refusal::None;
}

Refusal write_clear_counters(const State& /*state*/, BitWrite bits, Outcome& outcome) {
  outcome.counters_to_clear = static_cast<std::uint16_t>(bits.value & bits.mask);
  outcome.request(Effect::ClearCounters);
  return Refusal::None;
}

std::uint16_t read_counting_edge(const State& state) {
  return (state.settings.format & kFormatRisingEdge) != 0 ? 1 : 0;
}

Refusal write_counting_edge(const State& state, BitWrite bits, Outcome& outcome) {
  const unsigned others = state.settings.format & ~unsigned{kFormatRisingEdge};
  outcome.change().format = static_cast<std::uint8_t>(others | (bits.value != 0 ? kFormatRisingEdge : 0U));
  // A `%` command changes the edge at the next reset. A write of this coil changes the edge immediately, even
  // if the stored bit stays the same.
  outcome.request(Effect::TakeCountingEdge);
  return Refusal::None;
}

}  // namespace ex9000::modbus
