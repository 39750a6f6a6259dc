#include "firmware/request/request_cycle.hpp"

#include "firmware/dcon/dcon.hpp"
#include "firmware/modbus/modbus.hpp"

namespace ex9000 {

const Outcome& RequestCycle::judge(Bytes frame) {
  exchange_.begin(frame);
  reply_hold_.disarm();
  if (exchange_.state.speaks_modbus()) {
    modbus::answer(exchange_);
  } else {
    dcon::answer(exchange_);
  }
  exchange_.frame = {};
  exchange_.args = {};
  Outcome& outcome = exchange_.outcome;
  if (outcome.refusal != Refusal::None) {
    outcome.clear();  // no action of a refused request is carried out
  }
  if (outcome.changes_settings()) {
    phase_ = Phase::AwaitingStore;
  }
  return outcome;
}

void RequestCycle::keep_timeout_status() {
  if (phase_ == Phase::AwaitingStore || phase_ == Phase::Storing) {
    exchange_.outcome.change().timeout_status.reset();
  }
}

void RequestCycle::refuse_store() {
  exchange_.outcome.clear();
  exchange_.outcome.refusal = Refusal::StoreFailed;
  if (exchange_.state.speaks_modbus()) {
    modbus::refuse_store(exchange_);
  } else {
    dcon::refuse_store(exchange_);
  }
}

bool RequestCycle::finish() {
  exchange_.outcome.clear();
  phase_ = exchange_.reply.empty() ? Phase::Idle : Phase::ReplyReady;
  return phase_ == Phase::ReplyReady;
}

Bytes RequestCycle::take_reply(Time now) {
  if (phase_ != Phase::ReplyReady || !(until_reply(now) == Duration())) {
    return {};
  }
  phase_ = Phase::Replying;
  return exchange_.reply.bytes();
}

Duration RequestCycle::until_reply(Time now) const {
  const Duration gap = reply_gap_end_.armed() ? reply_gap_end_.remaining(now) : Duration();
  const Duration hold = reply_hold_.armed() ? reply_hold_.remaining(now) : Duration();
  return gap < hold ? hold : gap;
}

void RequestCycle::reply_sent(Time now, Duration silence) {
  phase_ = Phase::Idle;
  reply_gap_end_.set(now + silence);
}

void RequestCycle::end_reply_gap(Time now) {
  if (reply_gap_end_.reached(now)) {
    reply_gap_end_.disarm();
  }
}

}  // namespace ex9000
