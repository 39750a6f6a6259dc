// All channels at once, and the synchronised sample: manuals 2.2, 2.5, 2.7, 2.10 (EX9052D 2.13).
#include "firmware/dcon/commands.hpp"
#include "firmware/dcon/writing.hpp"

namespace ex9000::dcon {

namespace {

constexpr std::string_view kEndOfData = "00";

}  // namespace

Refusal take_sample(Exchange& exchange) {
  exchange.outcome.request(Effect::TakeSample);
  return Refusal::None;
}

Refusal read_sample(Exchange& exchange) {
  const Sample& sample = exchange.state.sample;
  if (!sample.taken) {
    return Refusal::NoSample;
  }
  exchange.outcome.request(Effect::MarkSampleRead);
  exchange.reply.put('!');
  exchange.reply.put(sample.read ? '0' : '1');
  put_data(exchange, sample.outputs, sample.inputs);
  exchange.reply.put(kEndOfData);
  return Refusal::None;
}

Refusal read_channels(Exchange& exchange) {
  exchange.reply.put('!');
  put_data(exchange, exchange.state.outputs, exchange.state.inputs.levels());
  exchange.reply.put(kEndOfData);
  return Refusal::None;
}

Refusal read_channels_short(Exchange& exchange) {
  exchange.reply.put('>');
  put_data(exchange, exchange.state.outputs, exchange.state.inputs.levels());
  return Refusal::None;
}

}  // namespace ex9000::dcon
