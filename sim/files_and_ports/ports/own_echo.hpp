// Distinguishes an adapter's echo from bytes that other stations send.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "firmware/bytes.hpp"
#include "hal/serial_mode.hpp"

namespace ex9000::sim {

/// Some adapters receive what they send. A real module ignores its own bytes (wire.md section 9). Without
/// this filter, a simulated module would receive its own reply as a request. For example, the module would
/// carry out its reply to Modbus function 05, because that reply equals the request.
class OwnEcho {
 public:
  using Clock = std::chrono::steady_clock;

  explicit OwnEcho(hal::SerialMode mode) : mode_(mode) {}

  /// Records that the program sends `bytes` at `now`, so that `in` expects their echo.
  void sent(Bytes bytes, Clock::time_point now) {
    const std::chrono::nanoseconds bits = std::chrono::seconds(bits_of_character(mode_.format));
    awaited_.insert(awaited_.end(), bytes.begin(), bytes.end());
    until_ = now + bits * awaited_.size() / mode_.baud + kLatency;
  }

  /// Returns how many bytes at the beginning of `heard` are echo. Compares `heard`, which the program has
  /// received at `now`, with the next bytes of the expected echo. After a different byte or a timeout (see
  /// `kLatency`), expects no more echo until the next call of `sent`.
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
  /// Maximum time from the end of the last byte on the line until the program reads its echo. An adapter may
  /// collect bytes for 16 ms, and a busy host may delay the program by seconds. If the limit were too short,
  /// a module could carry out its own reply. If the adapter has no echo and the next request arrives within
  /// this time, the request loses its leading bytes that match the reply.
  static constexpr std::chrono::seconds kLatency{10};

  hal::SerialMode mode_;
  std::deque<std::uint8_t> awaited_;
  Clock::time_point until_;
};

}  // namespace ex9000::sim
