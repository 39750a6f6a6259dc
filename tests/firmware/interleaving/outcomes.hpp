// The functions that return or check the outcome of a scenario when the module is idle again.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/firmware/interleaving/scenario.hpp"

namespace ex9000::interleaving {

/// The parts of an outcome. They are independent of each other.
using Parts = std::vector<std::string>;

inline Parts outputs_and_name(Bench& bench) {
  const Settings& settings = bench.module().state().settings;
  return {"outputs " + std::to_string(bench.hardware().outputs) + " name " +
          std::string(settings.name.bytes().begin(), settings.name.bytes().end())};
}

/// Returns one part for each of the channels 0 and 1, because the order of edges on different channels is not
/// defined: a command may see an edge on one channel, but not an earlier edge on another channel.
inline Parts inputs(Bench& bench) {
  const ex9000::Inputs& inputs = bench.module().state().inputs;
  Parts parts;
  for (unsigned channel = 0; channel < 2; ++channel) {
    const auto bit = [channel](unsigned channels) { return std::to_string(channels >> channel & 1U); };
    parts.push_back("channel " + std::to_string(channel) + " counter " +
                    std::to_string(inputs.counter(channel)) + " level " + bit(inputs.levels()) + " latches " +
                    bit(inputs.latched_high()) + bit(inputs.latched_low()));
  }
  return parts;
}

/// Returns the inputs after their filters have settled.
inline Parts settled_inputs(Bench& bench) {
  bench.rest(milliseconds(3));
  return inputs(bench);
}

/// Lets 2 ms pass and requires that all outputs are off. Returns the outputs and the name.
inline Parts switched_off(Bench& bench) {
  bench.rest(milliseconds(2));
  require(bench.hardware().outputs == 0, "a timed output stays on");
  return outputs_and_name(bench);
}

inline Parts no_matter(Bench& /*bench*/) { return {}; }

/// Checks that the host watchdog expires more than 100 ms and at most 100.003 ms after the last host OK. The
/// timeout of the watchdog must be 0.1 s.
inline Parts restarted(Bench& bench) {
  const std::uint32_t expires = bench.asked.at("host OK") + 100'000;
  const auto timed_out = [&] { return bench.module().state().settings.timeout_status; };
  require(!timed_out(), "the host watchdog has expired too early");
  bench.pass_time_until(expires);
  bench.whole_turn();
  require(!timed_out(), "a host OK was lost");
  bench.pass_time_until(expires + 3);
  bench.whole_turn();
  require(timed_out(), "a host OK was counted twice, or too late");
  bench.rest(milliseconds(10));  // during this time, the module stores the timeout status
  return {};
}

/// Does the same as `restarted` for Modbus, in which a host OK counts from the end of its silence.
inline Parts modbus_restarted(Bench& bench) {
  bench.asked["host OK"] +=
      LineTiming::reported_in_stop_bit(115200, LineFormat::k8N1).rtu_silence.microseconds();
  return restarted(bench);
}

}  // namespace ex9000::interleaving
