// The processing of a request, from its judgement to the end of its reply.
#pragma once

#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/request/exchange.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Tracks one request at a time: the request is judged once, changed settings are stored, the actions of the
/// request are carried out, and then its reply is sent. The cycle judges the request, tracks the phase and
/// keeps the reply; Module does the rest. For the main loop only. The functions do not block.
class RequestCycle {
 public:
  enum class Phase : std::uint8_t {
    Idle,           ///< the next request may be judged
    AwaitingStore,  ///< judged; the store of the changed settings has not begun
    Storing,        ///< judged; the memory is storing the changed settings
    ReplyReady,     ///< done; the reply waits until the gap after a reply and the response delay are over
    Replying,       ///< the reply is being sent
  };

  constexpr RequestCycle(const State& state, const LineTallies& tallies) : exchange_(state, tallies) {}

  [[nodiscard]] Phase phase() const { return phase_; }

  /// Judges a complete frame and returns its outcome. Call this only while Idle. Does not change the module's
  /// state, and does not keep the frame. If the outcome changes settings, the phase becomes AwaitingStore:
  /// these settings must be stored before the outcome is carried out. Call `finish` when the outcome has been
  /// carried out.
  const Outcome& judge(Bytes frame);
  /// Sets the earliest time of the reply to the request that is being processed. Call this after `judge`.
  void hold_reply_until(Time earliest) { reply_hold_.set(earliest); }
  /// Returns the outcome of the request. After `finish` it contains only the reason of a refusal.
  [[nodiscard]] const Outcome& outcome() const { return exchange_.outcome; }
  /// Changes the phase to Storing. Call this while AwaitingStore, when the store has begun.
  void store_begun() { phase_ = Phase::Storing; }
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

  /// Returns the reply if it may be sent now. Returns each reply only once. The result is empty if no reply
  /// is ready, or if it is too early to send the reply. The bytes are valid until `reply_sent`.
  Bytes take_reply(Time now);
  /// Ends the reply. Call this when its last stop bit has been sent and the driver is off. The next reply
  /// begins no earlier than the time `now` + `silence` (wire.md D18).
  void reply_sent(Time now, Duration silence);
  /// Disarms the deadline of the gap after a reply if the gap is over. Call this at least once every 30
  /// minutes: times wrap, so an old deadline would later appear to be in the future.
  void end_reply_gap(Time now);
  /// Returns the time until `take_reply` returns the reply. Call this only while ReplyReady.
  [[nodiscard]] Duration until_reply(Time now) const;

 private:
  Phase phase_ = Phase::Idle;
  Deadline reply_gap_end_;  ///< end of the minimum gap after the last reply
  Deadline reply_hold_;     ///< end of the response delay
  Exchange exchange_;
};

}  // namespace ex9000
