// The host watchdog: manuals 2.15 to 2.19 (EX9052D 2.17 to 2.21).
#include "firmware/dcon/commands.hpp"
#include "firmware/dcon/writing.hpp"
#include "firmware/hex.hpp"

namespace ex9000::dcon {

namespace {

constexpr unsigned kStatusEnabled = 0x80;
constexpr unsigned kStatusTimeout = 0x04;

unsigned status_of(const State& state) {
  const bool tells_enable = state.model().status_style == StatusStyle::EnableAndTimeout;
  if (state.settings.timeout_status) {
    return tells_enable ? kStatusEnabled | kStatusTimeout : kStatusTimeout;
  }
  return tells_enable && state.settings.watchdog_enabled ? kStatusEnabled : 0;
}

}  // namespace

/// The assembler hears `~**` in the interrupt, so that it is never lost, and keeps it from the queue; the
/// row's function says the same to whoever hands the frame to `answer`.
Refusal host_ok(const State& /*state*/, Bytes /*args*/, Outcome& outcome, Reply& /*reply*/) {
  outcome.restart_host_watchdog = true;
  return Refusal::None;
}

Refusal read_status(const State& state, Bytes /*args*/, Outcome& /*outcome*/, Reply& reply) {
  put_valid(state, reply);
  reply.put_hex(status_of(state));
  return Refusal::None;
}

Refusal clear_status(const State& state, Bytes /*args*/, Outcome& outcome, Reply& reply) {
  outcome.change.timeout_status(false);
  put_valid(state, reply);
  return Refusal::None;
}

Refusal read_watchdog(const State& state, Bytes /*args*/, Outcome& /*outcome*/, Reply& reply) {
  put_valid(state, reply);
  reply.put(state.settings.watchdog_enabled ? '1' : '0');
  reply.put_hex(state.settings.watchdog_timeout);
  return Refusal::None;
}

Refusal set_watchdog(const State& state, Bytes args, Outcome& outcome, Reply& reply) {
  const int timeout = hex_byte(args[1], args[2]);
  if ((args[0] != '0' && args[0] != '1') || timeout < 1) {
    return Refusal::OutOfRange;
  }
  const bool enable = args[0] == '1';
  outcome.change.watchdog_enabled(enable).watchdog_timeout(static_cast<std::uint8_t>(timeout));
  outcome.restart_host_watchdog = enable;
  put_valid(state, reply);
  return Refusal::None;
}

}  // namespace ex9000::dcon
