// The processing of a request, from its judgement to the end of its reply.
#pragma once

#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/crossing.hpp"
#include "firmware/expect.hpp"
#include "firmware/line/frame_queue.hpp"
#include "firmware/request/exchange.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// One request at a time: judge once, store changed settings, carry out the actions, send the reply. The
/// cycle judges, tracks the phase and keeps the reply; Module does the rest. Nothing blocks. Only
/// `on_reply_sent` is for interrupts.
class RequestCycle {
 public:
  enum class Phase : std::uint8_t {
    Idle,           ///< no request is being processed; the last reply may still be on the line
    Judged,         ///< changes no settings; its actions are being carried out
    AwaitingStore,  ///< judged; the store of the changed settings has not begun
    Storing,        ///< judged; the memory is storing the changed settings
    Updating,       ///< judged; the image slots work for the request (firmware/update)
    ReplyReady,     ///< done; the reply waits until the gap after a reply and the response delay are over
  };

  constexpr RequestCycle(const State& state, const LineTallies& tallies) : exchange_(state, tallies) {}

  [[nodiscard]] Phase phase() const { return phase_.load(); }
  /// The request waits for the memory.
  [[nodiscard]] bool stores() const { return phase() == Phase::AwaitingStore || phase() == Phase::Storing; }
  /// A reply is on the line. An interrupt reports its end, which needs no pass of the main loop.
  [[nodiscard]] bool replying() const { return replies_.load() != replies_sent_.load(); }
  /// No request is being processed, and no reply is on the line. For interrupts.
  [[nodiscard]] bool at_rest() const { return phase() == Phase::Idle && !replying(); }
  /// The next request may be judged. Becomes true in `poll`.
  [[nodiscard]] bool free() const { return phase() == Phase::Idle && replies_.load() == replies_ended_; }
  /// The shortest time between two replies (wire.md D18).
  void keep_apart(Duration replies) { gap_ = replies; }
  /// In every pass, at least once every 30 minutes.
  void poll(Time now);

  /// Only while `free()`. Does not keep the frame. If the phase becomes AwaitingStore, the changed settings
  /// must be stored before the outcome is carried out. Then call `finish`.
  const Outcome& judge(const Frame& frame, Time now);
  /// After `judge`.
  void hold_reply_until(Time earliest) { earliest_reply_.delay_to(Deadline(earliest)); }
  /// After `finish`, only the refusal.
  [[nodiscard]] const Outcome& outcome() const { return exchange_.outcome; }
  /// While AwaitingStore, when the store has begun.
  void store_begun() {
    EX9000_EXPECT(phase() == Phase::AwaitingStore);
    phase_.store_in_main_loop(Phase::Storing);
  }
  /// The host watchdog has expired: a request that `stores()` must not clear the new status (wire.md D17).
  void keep_timeout_status();
  /// While Storing or Updating, if the memory or the update failed: removes all actions and makes the reply
  /// an error, unless it is empty (broadcast). Then call `finish`.
  void refuse(Refusal refusal);
  /// When the outcome has been carried out, or after `refuse`. Whether there is a reply to send; if
  /// not, the next request may be judged.
  bool finish();

  /// Disarmed unless ReplyReady.
  [[nodiscard]] Deadline reply_due() const {
    return phase() == Phase::ReplyReady ? earliest_reply_ : Deadline();
  }
  /// The reply, once, when it may be sent; else empty. Valid until `on_reply_sent`.
  Bytes take_reply(Time now);
  /// For interrupts: the last stop bit has been sent and the driver is off.
  void on_reply_sent(Time now) {
    sent_at_.store_in_interrupt(now.microseconds());
    replies_sent_.store_in_interrupt(replies_.load());
  }

 private:
  WrittenByMainLoop<Phase> phase_;
  WrittenByMainLoop<std::uint32_t> replies_;  ///< number of replies that `take_reply` has returned; wraps
  WrittenByInterrupt<std::uint32_t> replies_sent_;  ///< the value of `replies_` when a reply ended
  std::uint32_t replies_ended_ = 0;            ///< the value of `replies_sent_` that `poll` has processed
  WrittenByInterrupt<std::uint32_t> sent_at_;  ///< end of the last reply
  Duration gap_;
  Deadline gap_end_;  ///< armed from the end of a reply until the next one may begin
  Deadline earliest_reply_;
  Exchange exchange_;
};

}  // namespace ex9000
