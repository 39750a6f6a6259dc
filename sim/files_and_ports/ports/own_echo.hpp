// Distinguishes an adapter's echo from bytes that other stations send.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "firmware/bytes.hpp"
#include "hal/serial_mode.hpp"

namespace ex9000::sim {

/// Some adapters receive what they send. A real module ignores its own bytes (wire.md section 9); a simulated
/// one would take its reply for a request, and carry out its reply to function 05, which equals the request.
class OwnEcho {
 public:
  using Clock = std::chrono::steady_clock;

  explicit OwnEcho(hal::SerialMode mode) : mode_(mode) {}

  /// `in` expects the echo of these bytes from `now` on.
  void sent(Bytes bytes, Clock::time_point now) {
    const std::chrono::nanoseconds bits = std::chrono::seconds(bits_of_character(mode_.format));
    awaited_.insert(awaited_.end(), bytes.begin(), bytes.end());
    until_ = now + bits * awaited_.size() / mode_.baud + kLatency;
  }

  /// How many leading bytes of `heard` are the echo. After a different byte or a timeout (`kLatency`), no
  /// more echo is expected until the next `sent`.
  [[nodiscard]] std::size_t in(Bytes heard, Clock::time_point now) {
    if (now > until_) {
      awaited_.clear();
    }
    std::size_t count = 0;
    while (count < heard.size && !awaited_.empty() && awaited_.front() == heard[count]) {
      awaited_.pop_front();
      ++count;
    }
    if (count < heard.size) {
      awaited_.clear();
    }
    return count;
  }

 private:
  /// From the end of the last byte on the line until the program reads its echo: an adapter may collect bytes
  /// for 16 ms, and a busy host may delay the program by seconds. If too short, a module could carry out its
  /// own reply. Without an echo, a request within this time loses leading bytes that match the reply.
  static constexpr std::chrono::seconds kLatency{10};

  hal::SerialMode mode_;
  std::deque<std::uint8_t> awaited_;
  Clock::time_point until_;
};

}  // namespace ex9000::sim
