// The coils and discrete inputs, and the functions that read and write them - wire.md section 7.
#pragma once

#include "firmware/registers/rows.hpp"

namespace ex9000::registers {

inline std::uint16_t read_outputs(const State& state) { return state.outputs; }

inline Refusal write_outputs(const State& /*state*/, BitWrite bits, Outcome& outcome) {
  outcome.drive(bits);
  return Refusal::None;
}

/// `setting`: the safe or the power-on value; `change`: the same member of SettingsChange.
template <auto setting, auto change>
Refusal write_preset_value(const State& state, BitWrite bits, Outcome& outcome) {
  outcome.change().*change = bits.applied_to(state.settings.*setting);
  return write_outputs(state, bits, outcome);
}

template <auto get>
std::uint16_t read_inputs(const State& state) {
  return (state.inputs.*get)();
}

template <auto setting>
std::uint16_t read_setting(const State& state) {
  return static_cast<std::uint16_t>(state.settings.*setting);
}

inline Refusal write_protocol(const State& /*state*/, BitWrite bits, Outcome& outcome) {
  outcome.change().protocol = bits.value != 0 ? Protocol::ModbusRtu : Protocol::Ascii;
  return Refusal::None;
}

inline Refusal write_watchdog_enable(const State& /*state*/, BitWrite bits, Outcome& outcome) {
  const bool enable = bits.value != 0;
  outcome.change().watchdog_enabled = enable;
  if (enable) {
    outcome.request(Effect::RestartHostWatchdog);
  }
  return Refusal::None;
}

inline Refusal clear_latches(const State& /*state*/, BitWrite /*bits*/, Outcome& outcome) {
  outcome.request(Effect::ClearLatches);
  return Refusal::None;
}

inline Refusal clear_timeout_status(const State& /*state*/, BitWrite /*bits*/, Outcome& outcome) {
  outcome.change().timeout_status = false;
  return Refusal::None;
}

inline Refusal clear_counters(const State& /*state*/, BitWrite bits, Outcome& outcome) {
  outcome.counters_to_clear = static_cast<std::uint16_t>(bits.value & bits.mask);
  outcome.request(Effect::ClearCounters);
  return Refusal::None;
}

inline std::uint16_t read_counting_edge(const State& state) {
  return (state.settings.format & kFormatRisingEdge) != 0 ? 1 : 0;
}

inline Refusal write_counting_edge(const State& state, BitWrite bits, Outcome& outcome) {
  const unsigned others = state.settings.format & ~unsigned{kFormatRisingEdge};
  outcome.change().format = static_cast<std::uint8_t>(others | (bits.value != 0 ? kFormatRisingEdge : 0U));
  // At once, even if the stored bit stays the same; a `%` command changes the edge at the next reset.
  outcome.request(Effect::TakeCountingEdge);
  return Refusal::None;
}

inline constexpr BitRegister kBitRegisters[] = {
    {"outputs",
     "outputs",
     "0 off, 1 on",
     {0x0000, Width::PerOutput, Needs::Outputs, kReadCoils | kWriteSingleCoil | kWriteMultipleCoils, kPlain,
      read_outputs, write_outputs}},
    {"inputs",
     "inputs",
     "",
     {0x0000, Width::PerInput, Needs::Inputs, kReadDiscreteInputs, kPlain, read_inputs<&Inputs::levels>,
      nullptr}},
    {"input-coils",
     "inputs",
     "",
     {0x0020, Width::PerInput, Needs::Inputs, kReadCoils, kPlain, read_inputs<&Inputs::levels>, nullptr}},
    {"latch-high",
     "latch high: a rising edge has occurred",
     "",
     {0x0040, Width::PerInput, Needs::Inputs, kReadCoils, kPlain, read_inputs<&Inputs::latched_high>,
      nullptr}},
    {"latch-low",
     "latch low: a falling edge has occurred",
     "",
     {0x0060, Width::PerInput, Needs::Inputs, kReadCoils, kPlain, read_inputs<&Inputs::latched_low>,
      nullptr}},
    {"safe-value",
     "safe value; a write also drives the outputs",
     "0 off, 1 on",
     {0x0080, Width::PerOutput, Needs::Outputs, kReadCoils | kWriteSingleCoil | kWriteMultipleCoils, kPlain,
      read_setting<&Settings::safe_value>,
      write_preset_value<&Settings::safe_value, &SettingsChange::safe_value>}},
    {"power-on-value",
     "power-on value; a write also drives the outputs",
     "0 off, 1 on",
     {0x00A0, Width::PerOutput, Needs::Outputs, kReadCoils | kWriteSingleCoil | kWriteMultipleCoils, kPlain,
      read_setting<&Settings::power_on_value>,
      write_preset_value<&Settings::power_on_value, &SettingsChange::power_on_value>}},
    {"protocol",
     "stored protocol, in force from the next reset on",
     "0 ASCII, 1 Modbus RTU; not by broadcast",
     {0x0100, Width::One, Needs::Nothing, kReadCoils | kWriteSingleCoil, kConfiguration,
      read_setting<&Settings::protocol>, write_protocol}},
    {"watchdog-enable",
     "host watchdog enable",
     "0 off, 1 on and restart; 1 only if the timeout is not 0",
     {0x0104, Width::One, Needs::Nothing, kReadCoils | kWriteSingleCoil, kPlain,
      read_setting<&Settings::watchdog_enabled>, write_watchdog_enable}},
    {"clear-latches",
     "clear both latches of all channels",
     "1 only",
     {0x0107, Width::One, Needs::Inputs, kWriteSingleCoil, kOnlyOn, nullptr, clear_latches}},
    {"timeout-status",
     "host watchdog timeout status",
     "1 only: clears it",
     {0x010D, Width::One, Needs::Nothing, kReadCoils | kWriteSingleCoil, kOnlyOn,
      read_setting<&Settings::timeout_status>, clear_timeout_status}},
    {"clear-counters",
     "clear the channel's counter",
     "1 clears it; 0 changes nothing and requires function 0F",
     {0x0200, Width::PerInput, Needs::Inputs, kWriteSingleCoil | kWriteMultipleCoils, kOnlyOn, nullptr,
      clear_counters}},
    {"counting-edge",
     "edge that the counters count, stored and in force immediately",
     "0 falling, 1 rising; not by broadcast",
     {0x08CA, Width::One, Needs::Inputs, kReadCoils | kWriteSingleCoil, kConfiguration, read_counting_edge,
      write_counting_edge}},
};

}  // namespace ex9000::registers
