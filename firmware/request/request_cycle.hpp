// A request from the moment it is judged to the end of its reply.
#pragma once

#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/request/exchange.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// One request at a time: it is judged once; if it changes settings, they are stored; what it asks for is
/// done; then its reply is sent. The module does all that; the cycle says what comes next. Main loop only;
/// nothing blocks.
class RequestCycle {
 public:
  enum class Phase : std::uint8_t {
    Idle,           ///< the next request may be judged
    AwaitingStore,  ///< judged; the memory is busy with another store
    Storing,        ///< judged; the memory takes the changed settings
    ReplyReady,     ///< done; the reply waits until the line has been quiet for long enough
    Replying,       ///< the driver is on
  };

  constexpr RequestCycle(const State& state, const LineTallies& tallies) : exchange_(state, tallies) {}

  [[nodiscard]] Phase phase() const { return phase_; }

  /// Only while Idle. Judges a complete frame, which need not live any longer; changes nothing but the
  /// outcome. If that changes settings, the cycle is AwaitingStore; otherwise call `finish` when the rest of
  /// the outcome is done.
  const Outcome& judge(Bytes frame);
  /// What the request asks for. After `finish`: nothing more, and the reason of a refusal.
  [[nodiscard]] const Outcome& outcome() const { return exchange_.outcome; }
  /// While AwaitingStore: the store has begun.
  void store_begun() { phase_ = Phase::Storing; }
  /// While AwaitingStore or Storing: the host watchdog has expired. A request that clears the timeout status
  /// clears the one before, not this one (wire.md D17).
  void keep_timeout_status();
  /// While Storing: the memory did not take the settings. Nothing is to be done; the reply says so.
  void refuse_store();
  /// All is done: the reply may leave, or the next request may come if there is none. True: a reply is ready.
  bool finish();

  /// The reply to send now; empty: none, or not yet. It lives until `reply_sent`.
  Bytes take_reply(Time now);
  /// The last stop bit has left and the driver is off. The next reply leaves `silence` after it (wire.md
  /// D18).
  void reply_sent(Time now, Duration silence);
  /// Every few minutes at least, because a deadline that nobody asks for becomes one that lies ahead.
  void forget_old_reply(Time now);
  /// When `take_reply` will return the reply; only while ReplyReady.
  [[nodiscard]] Duration until_reply(Time now) const;

 private:
  Phase phase_ = Phase::Idle;
  Deadline line_quiet_;  ///< armed after a reply
  Exchange exchange_;
};

}  // namespace ex9000
