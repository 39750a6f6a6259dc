// Reading all channels, now or at one moment on all modules: manuals 2.2, 2.5, 2.7, 2.10 (EX9052D 2.13).
#include "firmware/dcon/commands.hpp"
#include "firmware/dcon/writing.hpp"

namespace ex9000::dcon {

namespace {

constexpr std::string_view kEndOfData = "00";

}  // namespace

Refusal take_sample(const State& /*state*/, Bytes /*args*/, Outcome& outcome, Reply& /*reply*/) {
  outcome.take_sample = true;
  return Refusal::None;
}

Refusal read_sample(const State& state, Bytes /*args*/, Outcome& outcome, Reply& reply) {
  const Sample& sample = state.sample;
  if (!sample.taken) {
    return Refusal::NoSample;
  }
  outcome.sample_read = true;
  reply.put('!');
  reply.put(sample.read ? '0' : '1');
  put_data(state.model(), sample.outputs, sample.inputs, reply);
  reply.put(kEndOfData);
  return Refusal::None;
}

Refusal read_channels(const State& state, Bytes /*args*/, Outcome& /*outcome*/, Reply& reply) {
  reply.put('!');
  put_data(state.model(), state.outputs, state.inputs.levels(), reply);
  reply.put(kEndOfData);
  return Refusal::None;
}

Refusal read_channels_short(const State& state, Bytes /*args*/, Outcome& /*outcome*/, Reply& reply) {
  reply.put('>');
  put_data(state.model(), state.outputs, state.inputs.levels(), reply);
  return Refusal::None;
}

}  // namespace ex9000::dcon
