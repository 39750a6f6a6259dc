#include "firmware/dcon/dcon.hpp"

#include <array>

#include "firmware/dcon/commands.hpp"
#include "firmware/hex.hpp"
#include "firmware/model/built.hpp"

namespace ex9000::dcon {

namespace {

constexpr std::size_t kBodyAt = 3;

constexpr auto kDispatch = rows_of_built_models<kCommands, &Command::dispatch>();

bool is_broadcast(Bytes frame) { return frame[1] == '*'; }

Bytes arguments(const Dispatch& row, Bytes frame) {
  const bool has_key = row.key != kNoKey && row.key != kBroadcastKey;
  return frame.from(kBodyAt + (has_key ? 1 : 0));
}

bool matches(const Dispatch& row, const Model& model, Bytes frame) {
  if (row.delimiter != static_cast<char>(frame[0])) {
    return false;
  }
  const bool key_matches =
      is_broadcast(frame)
          ? row.key == kBroadcastKey
          : row.key == kNoKey || (frame.size > kBodyAt && row.key == static_cast<char>(frame[kBodyAt]));
  if (!key_matches) {
    return false;
  }
  const std::size_t args = arguments(row, frame).size;
  return args >= row.fewest_args && args <= row.most_args && has(model, row.needs);
}

/// Only a model with outputs refuses without an address: `@AA` with data, and each `#AA...` except `#AAN` if
/// it has inputs too (manuals 2.3, 2.11; wire.md D12).
bool refused_without_address(const Model& model, Bytes frame) {
  const std::size_t body = frame.size - kBodyAt;
  if (!model.has_outputs()) {
    return false;
  }
  if (frame[0] == '#') {
    return !(model.has_inputs() && body == 1);
  }
  return frame[0] == '@';  // a refused `@` frame has data, because `@AA` without data is never refused
}

/// The configuration permission, wire.md section 2.
bool needs_permission(const Dispatch& row, const Exchange& exchange) {
  if (row.init != Init::ToChangeLine) {
    return row.init == Init::Required;
  }
  const Settings& stored = exchange.state.settings;
  const Settings changed = exchange.outcome.change().applied_to(stored);
  return changed.baud_code != stored.baud_code || ((changed.format ^ stored.format) & kFormatChecksum) != 0;
}

Refusal judge(const Dispatch& row, Exchange& exchange) {
  const Refusal refusal = row.handler(exchange);
  if (refusal != Refusal::None) {
    return refusal;
  }
  if (!exchange.state.configuration_permitted() && needs_permission(row, exchange)) {
    return Refusal::NotPermitted;
  }
  return exchange.judge_outcome();
}

void refuse(Exchange& exchange, Refusal refusal) {
  Reply& reply = exchange.reply;
  reply.clear();
  if (refusal == Refusal::OutputsBlocked) {
    reply.put('!');
    return;
  }
  reply.put('?');
  if (refusal == Refusal::StoreFailed || !refused_without_address(exchange.model(), exchange.frame)) {
    reply.put_hex(exchange.state.in_force.address);
  }
}

void finish(Exchange& exchange) {
  Reply& reply = exchange.reply;
  if (reply.empty()) {
    return;
  }
  if (exchange.state.in_force.checksum) {
    unsigned sum = 0;
    for (const std::uint8_t byte : reply.bytes()) {
      sum += byte;
    }
    reply.put_hex(sum);
  }
  reply.put('\r');
}

}  // namespace

std::size_t find_command(const Model& model, Bytes frame) {
  for (std::size_t i = 0; i < kDispatch.size(); ++i) {
    if (matches(kDispatch[i], model, frame)) {
      return i;
    }
  }
  return kNoCommand;
}

void answer(Exchange& exchange) {
  const Bytes frame = exchange.frame;
  if (!is_broadcast(frame) && hex_byte(frame[1], frame[2]) != exchange.state.in_force.address) {
    return;  // `%` has changed the address since the frame was received (wire.md D16)
  }
  Refusal refusal = Refusal::UnknownCommand;
  const std::size_t command = find_command(exchange.model(), frame);
  if (command != kNoCommand) {
    exchange.args = arguments(kDispatch[command], frame);
    refusal = judge(kDispatch[command], exchange);
  }
  exchange.outcome.refusal = refusal;
  if (refusal != Refusal::None) {
    refuse(exchange, refusal);
  }
  finish(exchange);
}

void refuse_store(Exchange& exchange) {
  refuse(exchange, Refusal::StoreFailed);
  finish(exchange);
}

}  // namespace ex9000::dcon
