// Commands for counters and latches: EX9052D manual 2.3, 2.10 to 2.12.
#include "firmware/dcon/commands.hpp"
#include "firmware/dcon/writing.hpp"
#include "firmware/hex.hpp"

namespace ex9000::dcon {

namespace {

constexpr unsigned kNoChannel = kMaxInputs;

/// kNoChannel unless `digit` is an upper-case hex digit of a channel that the model has.
unsigned channel_of(const Model& model, std::uint8_t digit) {
  const int channel = hex_value(digit);
  return channel >= 0 && channel < model.inputs ? static_cast<unsigned>(channel) : kNoChannel;
}

}  // namespace

Refusal read_counter(Exchange& exchange) {
  const unsigned channel = channel_of(exchange.model(), exchange.args[0]);
  if (channel == kNoChannel) {
    return Refusal::OutOfRange;
  }
  put_valid(exchange);
  const std::uint32_t count = exchange.state.inputs.counter(channel);
  for (std::uint32_t unit = 10'000; unit != 0; unit /= 10) {
    exchange.reply.put(hex_digit(count / unit % 10));
  }
  return Refusal::None;
}

Refusal clear_latches(Exchange& exchange) {
  exchange.outcome.request(Effect::ClearLatches);
  put_valid(exchange);
  return Refusal::None;
}

Refusal clear_counter(Exchange& exchange) {
  const unsigned channel = channel_of(exchange.model(), exchange.args[0]);
  if (channel == kNoChannel) {
    return Refusal::OutOfRange;
  }
  exchange.outcome.counters_to_clear = static_cast<std::uint16_t>(1U << channel);
  exchange.outcome.request(Effect::ClearCounters);
  put_valid(exchange);
  return Refusal::None;
}

Refusal read_latches(Exchange& exchange) {
  if (exchange.args[0] != '0' && exchange.args[0] != '1') {
    return Refusal::OutOfRange;
  }
  // Outputs have no latches, so on a module with both, First is 00.
  const Inputs& inputs = exchange.state.inputs;
  exchange.reply.put('!');
  put_data(exchange, 0, exchange.args[0] == '1' ? inputs.latched_high() : inputs.latched_low());
  exchange.reply.put_hex(0);
  return Refusal::None;
}

}  // namespace ex9000::dcon
