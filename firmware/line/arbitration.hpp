// The arbitration of a bus scan, by which one module of all wins the right to reply - extensions.md, scan.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/crossing.hpp"
#include "firmware/line/timing.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Driven by the silence timer and by received bytes, in interrupts: 32 windows, one for each bit of a word,
/// most significant first. In a window, a 0 is sent as one byte FF, and a 1 is silence. A module that hears a
/// byte in a window of a 1 has lost, so the lowest word wins, and its module replies after the last window.
class Arbitration {
 public:
  /// For which the master asks: in the first one of a scan, all modules are unscanned again.
  enum class Round : std::uint8_t { None, First, Next };
  struct Contender {
    std::uint32_t serial_number;  ///< 0: none, so that it takes no part
    std::uint8_t address;         ///< in force
  };

  void use(const LineTiming& timing) { timing_ = timing; }

  // --- interrupts, which must not interrupt each other ---

  /// A request for a round, not None, has ended. `reported`: when the UART reported its last byte. Then call
  /// `on_time`.
  void begin(Round round, const Contender& who, Time reported);
  /// From `begin` until the module has lost, gives up, or has begun its reply.
  [[nodiscard]] bool active() const { return window_ != kOver; }

  /// While `active`, when the time that it returned has passed; 0: the arbitration is over for this module.
  /// The bytes of `take_burst` must then be sent at once. Gives up unless `at_rest`: no request is being
  /// processed. `line_low`: a start bit is on the line.
  Duration on_time(Time now, bool line_low, bool at_rest);
  /// FF, the reply, or nothing; once. Valid until `on_sent`.
  Bytes take_burst();
  /// When the driver is off again.
  void on_sent() { sending_.store_in_interrupt(false); }

  /// A byte has arrived while `active`. True if it belongs to the arbitration; else the arbitration is over
  /// for this module, and the byte may begin a frame.
  bool hears_byte();

  // --- main loop ---

  /// A burst has not ended although it should have by `now`.
  [[nodiscard]] bool jams(Time now) const;

 private:
  static constexpr unsigned kWindows = 32;
  static constexpr unsigned kOver = kWindows + 1;
  static constexpr std::size_t kLongestReply = 10;

  [[nodiscard]] bool bit_before(unsigned window) const { return (word_ >> (kWindows - window) & 1U) != 0; }
  Bytes write_reply();
  void send(Bytes burst, Time now);

  LineTiming timing_{};
  Contender who_{};
  bool scanned_ = false;  ///< since the last first round, the module has won
  std::uint32_t word_ = 0;
  Time begin_;               ///< of the first window
  unsigned window_ = kOver;  ///< the next one; kWindows: the reply
  Bytes burst_;              ///< to be sent
  std::array<std::uint8_t, kLongestReply> reply_{};
  WrittenByInterrupt<bool> sending_;
  WrittenByInterrupt<std::uint32_t> sent_since_;
};

}  // namespace ex9000
