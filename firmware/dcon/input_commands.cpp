// Counters and latches: EX9052D manual 2.3, 2.10 to 2.12.
#include "firmware/dcon/commands.hpp"
#include "firmware/dcon/writing.hpp"

namespace ex9000::dcon {

namespace {

constexpr unsigned kNoChannel = kMaxInputs;

/// N as a channel of this model, or kNoChannel.
unsigned channel_of(const Model& model, std::uint8_t digit) {
  const unsigned channel = digit - unsigned{'0'};
  return channel < model.inputs ? channel : kNoChannel;
}

}  // namespace

Refusal read_counter(const State& state, Bytes args, Outcome& /*outcome*/, Reply& reply) {
  const unsigned channel = channel_of(state.model(), args[0]);
  if (channel == kNoChannel) {
    return Refusal::OutOfRange;
  }
  put_valid(state, reply);
  const std::uint32_t count = state.inputs.counter(channel);
  for (std::uint32_t unit = 10'000; unit != 0; unit /= 10) {
    reply.put(hex_digit(count / unit % 10));
  }
  return Refusal::None;
}

Refusal clear_latches(const State& state, Bytes /*args*/, Outcome& outcome, Reply& reply) {
  outcome.clear_latches = true;
  put_valid(state, reply);
  return Refusal::None;
}

Refusal clear_counter(const State& state, Bytes args, Outcome& outcome, Reply& reply) {
  const unsigned channel = channel_of(state.model(), args[0]);
  if (channel == kNoChannel) {
    return Refusal::OutOfRange;
  }
  outcome.clear_counters = static_cast<std::uint16_t>(1U << channel);
  put_valid(state, reply);
  return Refusal::None;
}

Refusal read_latches(const State& state, Bytes args, Outcome& /*outcome*/, Reply& reply) {
  if (args[0] != '0' && args[0] != '1') {
    return Refusal::OutOfRange;
  }
  // On a module with both, First is where the outputs stand elsewhere; here it is 00.
  const Inputs& inputs = state.inputs;
  reply.put('!');
  put_data(state.model(), 0, args[0] == '1' ? inputs.latched_high() : inputs.latched_low(), reply);
  reply.put_hex(0);
  return Refusal::None;
}

}  // namespace ex9000::dcon
