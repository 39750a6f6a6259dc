// The processing of a request, from its judgement to the end of its reply.
#pragma once

#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/crossing.hpp"
#include "firmware/expect.hpp"
#include "firmware/request/exchange.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Tracks one request at a time: the request is judged once, changed settings are stored, the actions of the
/// request are carried out, and then its reply is sent. The cycle judges the request, tracks the phase and
/// keeps the reply; Module does the rest. For the main loop, except where a comment says otherwise. The
/// functions do not block.
class RequestCycle {
 public:
  enum class Phase : std::uint8_t {
    Idle,           ///< no request is being processed; the last reply may still be on the line
    AwaitingStore,  ///< judged; the store of the changed settings has not begun
    Storing,        ///< judged; the memory is storing the changed settings
    ReplyReady,     ///< done; the reply waits until the gap after a reply and the response delay are over
  };

  constexpr RequestCycle(const State& state, const LineTallies& tallies) : exchange_(state, tallies) {}

  [[nodiscard]] Phase phase() const { return phase_; }
  /// Whether the request that is being processed waits for the memory.
  [[nodiscard]] bool stores() const { return phase_ == Phase::AwaitingStore || phase_ == Phase::Storing; }
  /// Whether a reply is on the line. Its end, which an interrupt reports, needs no pass of the main loop.
  [[nodiscard]] bool replying() const { return replies_.load() != replies_sent_.load(); }
  /// Whether the next request may be judged. Becomes true in `poll`.
  [[nodiscard]] bool free() const { return phase_ == Phase::Idle && replies_.load() == replies_ended_; }
  /// Sets the shortest time between two replies (wire.md D18).
  void keep_apart(Duration replies) { gap_ = replies; }
  /// Call this in every pass, at least once every 30 minutes.
  void poll(Time now);

  /// Judges a complete frame and returns its outcome. Call this only while `free()`. Does not change the
  /// module's state, and does not keep the frame. If the outcome changes settings, the phase becomes
  /// AwaitingStore: these settings must be stored before the outcome is carried out. Call `finish` when the
  /// outcome has been carried out.
  const Outcome& judge(Bytes frame, Time now);
  /// Delays the reply to the request that is being processed. Call this after `judge`.
  void hold_reply_until(Time earliest) { earliest_reply_.delay_to(Deadline(earliest)); }
  /// Returns the outcome of the request. After `finish` it contains only the reason of a refusal.
  [[nodiscard]] const Outcome& outcome() const { return exchange_.outcome; }
  /// Changes the phase to Storing. Call this while AwaitingStore, when the store has begun.
  void store_begun() {
    EX9000_EXPECT(phase_ == Phase::AwaitingStore);
    phase_ = Phase::Storing;
  }
  /// Removes the change of the timeout status from the request, if the phase is AwaitingStore or Storing.
  /// Call this when the host watchdog has expired, because the request must not clear the new timeout status
  /// (wire.md D17).
  void keep_timeout_status();
  /// Removes all actions of the request and replaces the reply with an error reply. The empty reply to a
  /// broadcast stays empty. Call this while Storing, if the memory did not store the settings, and then call
  /// `finish`.
  void refuse_store();
  /// Ends the processing of the request. Returns true if there is a reply to send; otherwise the next request
  /// may be judged. Call this when the outcome has been carried out, or after `refuse_store`.
  bool finish();

  /// When `take_reply` returns the reply; disarmed unless ReplyReady.
  [[nodiscard]] Deadline reply_due() const {
    return phase_ == Phase::ReplyReady ? earliest_reply_ : Deadline();
  }
  /// Returns the reply if it may be sent now. Returns each reply only once. The result is empty if no reply
  /// is ready, or if it is too early to send the reply. The bytes are valid until `on_reply_sent`.
  Bytes take_reply(Time now);
  /// Ends the reply. Call this when its last stop bit has been sent and the driver is off. For interrupts.
  void on_reply_sent(Time now) {
    sent_at_.store_in_interrupt(now.microseconds());
    replies_sent_.store_in_interrupt(replies_.load());
  }

 private:
  Phase phase_ = Phase::Idle;
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
