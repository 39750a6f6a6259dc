#include "firmware/dcon/dcon.hpp"

#include <array>

#include "firmware/dcon/commands.hpp"
#include "firmware/hex.hpp"
#include "firmware/model/built.hpp"

namespace ex9000::dcon {

namespace {

constexpr std::size_t kBodyAt = 3;

/// The rows without their texts.
constexpr auto kDispatch = rows_of_built_models<kCommands, &Command::dispatch>();

bool is_broadcast(Bytes frame) { return frame[1] == '*'; }

/// What stands behind the key.
Bytes arguments(const Dispatch& row, Bytes frame) {
  const bool has_key = row.key != kNoKey && row.key != kBroadcastKey;
  return frame.from(kBodyAt + (has_key ? 1 : 0));
}

bool matches(const Dispatch& row, const Model& model, Bytes frame) {
  if (row.delimiter != static_cast<char>(frame[0]) || is_broadcast(frame) != (row.key == kBroadcastKey)) {
    return false;
  }
  if (row.key != kNoKey && row.key != kBroadcastKey &&
      (frame.size <= kBodyAt || row.key != static_cast<char>(frame[kBodyAt]))) {
    return false;
  }
  const std::size_t args = arguments(row, frame).size;
  return args >= row.fewest_args && args <= row.most_args && meets(model, row.needs);
}

/// Refused commands that set outputs are answered without the address (manuals 2.3, 2.11); D12 says which
/// they are.
bool refused_without_address(const Model& model, Bytes frame) {
  const std::size_t body = frame.size - kBodyAt;
  if (!model.has_outputs()) {
    return false;
  }
  if (frame[0] == '#') {
    return !(model.has_inputs() && body == 1);
  }
  return frame[0] == '@' && body != 0;
}

void refuse(const State& state, Bytes frame, Refusal refusal, Reply& reply) {
  reply.clear();
  if (refusal == Refusal::OutputsBlocked) {
    reply.put('!');
    return;
  }
  reply.put('?');
  if (!refused_without_address(state.model(), frame)) {
    reply.put_hex(state.in_force.address);
  }
}

/// Checksum, where it is in force, and CR.
void finish(const State& state, Reply& reply) {
  if (reply.empty()) {
    return;
  }
  if (state.in_force.checksum) {
    unsigned sum = 0;
    for (const std::uint8_t byte : reply.bytes()) {
      sum += byte;
    }
    reply.put_hex(sum & 0xFFU);
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

void answer(const State& state, Bytes frame, Outcome& outcome, Reply& reply) {
  if (!is_broadcast(frame) && hex_byte(frame[1], frame[2]) != state.in_force.address) {
    return;  // `%` has changed the address since the frame came in (D16)
  }
  const std::size_t command = find_command(state.model(), frame);
  outcome.refusal = command == kNoCommand ? Refusal::UnknownCommand
                                          : kDispatch[command].handler(
                                                state, arguments(kDispatch[command], frame), outcome, reply);
  if (outcome.refusal != Refusal::None) {
    refuse(state, frame, outcome.refusal, reply);
  }
  finish(state, reply);
}

void refuse_store(const State& state, Reply& reply) {
  reply.clear();
  reply.put('?');
  reply.put_hex(state.in_force.address);
  finish(state, reply);
}

}  // namespace ex9000::dcon
