// Tells an adapter's echo from what others send.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <deque>

#include "firmware/bytes.hpp"

namespace ex9000::sim {

/// Some adapters hear what they send. A module ignores that (wire.md section 9), and would otherwise obey its
/// own replies: that to a Modbus function 05 is the request once more.
class OwnEcho {
 public:
  using Clock = std::chrono::steady_clock;

  explicit OwnEcho(std::uint32_t baud) : baud_(baud) {}

  void sent(Bytes bytes, Clock::time_point now) {
    constexpr std::chrono::nanoseconds kCharacterBits{10'000'000'000};
    awaited_.insert(awaited_.end(), bytes.begin(), bytes.end());
    until_ = now + kCharacterBits * static_cast<std::int64_t>(awaited_.size()) / baud_ + kLatency;
  }

  /// How many of the bytes that were heard at `now` are the echo: those from the first on that are what was
  /// sent, in its order. Another byte, or none for too long, and the rest of it is not awaited any more.
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
  /// From the end of a byte on the line until it is here: an adapter may collect for 16 ms.
  static constexpr std::chrono::milliseconds kLatency{100};

  std::int64_t baud_;
  std::deque<std::uint8_t> awaited_;
  Clock::time_point until_;
};

}  // namespace ex9000::sim
