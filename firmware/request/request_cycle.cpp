#include "firmware/request/request_cycle.hpp"

#include "firmware/dcon/dcon.hpp"
#include "firmware/expect.hpp"
#include "firmware/modbus/modbus.hpp"

namespace ex9000 {

void RequestCycle::poll(Time now) {
  const std::uint32_t sent = replies_sent_.load();
  if (replies_ended_ != sent) {
    replies_ended_ = sent;
    gap_end_.set(Time(sent_at_.load()) + gap_);
  }
  if (gap_end_.reached(now)) {
    gap_end_.disarm();
  }
}

const Outcome& RequestCycle::judge(const Frame& frame, Time now) {
  EX9000_EXPECT(free());
  exchange_.begin(frame);
  earliest_reply_.set(now);
  earliest_reply_.delay_to(gap_end_);
  if (exchange_.state.speaks_modbus()) {
    modbus::answer(exchange_);
  } else {
    dcon::answer(exchange_);
  }
  Outcome& outcome = exchange_.outcome;
  if (outcome.refusal != Refusal::None) {
    outcome.clear();  // no action of a refused request is carried out
  }
  phase_.store_in_main_loop(outcome.changes_settings()                              ? Phase::AwaitingStore
                            : outcome.asked_of_update().ask != update::Ask::Nothing ? Phase::Updating
                                                                                    : Phase::Judged);
  return outcome;
}

void RequestCycle::keep_timeout_status() {
  if (stores()) {
    exchange_.outcome.change().timeout_status.reset();
  }
}

void RequestCycle::refuse(Refusal refusal) {
  EX9000_EXPECT(phase() == Phase::Storing || phase() == Phase::Updating);
  exchange_.outcome.clear();
  exchange_.outcome.refusal = refusal;
  if (exchange_.state.speaks_modbus()) {
    modbus::refuse(exchange_);
  } else {
    dcon::refuse_store(exchange_);
  }
}

bool RequestCycle::finish() {
  exchange_.outcome.clear();
  const bool replies = !exchange_.reply.empty();
  phase_.store_in_main_loop(replies ? Phase::ReplyReady : Phase::Idle);
  return replies;
}

Bytes RequestCycle::take_reply(Time now) {
  if (phase() != Phase::ReplyReady || !earliest_reply_.reached(now)) {
    return {};
  }
  EX9000_EXPECT(!replying());
  replies_.store_in_main_loop(replies_.load() + 1U);  // before the phase, see `at_rest`
  phase_.store_in_main_loop(Phase::Idle);
  return exchange_.reply.bytes();
}

}  // namespace ex9000
