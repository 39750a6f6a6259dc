// Commands for the host watchdog: manuals 2.15 to 2.19 (EX9052D 2.17 to 2.21).
#include "firmware/dcon/commands.hpp"
#include "firmware/dcon/writing.hpp"
#include "firmware/hex.hpp"

namespace ex9000::dcon {

namespace {

constexpr unsigned kStatusEnabled = 0x80;
constexpr unsigned kStatusTimeout = 0x04;

unsigned status_of(const State& state) {
  const bool reports_enable = state.model().status_style == StatusStyle::EnableAndTimeout;
  if (state.settings.timeout_status) {
    return reports_enable ? kStatusEnabled | kStatusTimeout : kStatusTimeout;
  }
  return reports_enable && state.settings.watchdog_enabled ? kStatusEnabled : 0;
}

}  // namespace

/// Only for a caller that passes `~**` to `answer`. A module never does: its receiver takes `~**` in the
/// interrupt and does not queue it, so that no host OK is lost. Either way the host watchdog restarts.
Refusal host_ok(Exchange& exchange) {
  exchange.outcome.request(Effect::RestartHostWatchdog);
  return Refusal::None;
}

Refusal read_status(Exchange& exchange) {
  put_valid(exchange);
  exchange.reply.put_hex(status_of(exchange.state));
  return Refusal::None;
}

Refusal clear_status(Exchange& exchange) {
  exchange.outcome.change().timeout_status = false;
  put_valid(exchange);
  return Refusal::None;
}

Refusal read_watchdog(Exchange& exchange) {
  put_valid(exchange);
  exchange.reply.put(exchange.state.settings.watchdog_enabled ? '1' : '0');
  exchange.reply.put_hex(exchange.state.settings.watchdog_timeout);
  return Refusal::None;
}

Refusal set_watchdog(Exchange& exchange) {
  const int timeout = hex_byte(exchange.args[1], exchange.args[2]);
  if ((exchange.args[0] != '0' && exchange.args[0] != '1') || timeout < 1) {
    return Refusal::OutOfRange;
  }
  const bool enable = exchange.args[0] == '1';
  exchange.outcome.change().watchdog_enabled = enable;
  exchange.outcome.change().watchdog_timeout = static_cast<std::uint8_t>(timeout);
  if (enable) {
    exchange.outcome.request(Effect::RestartHostWatchdog);
  }
  put_valid(exchange);
  return Refusal::None;
}

}  // namespace ex9000::dcon
