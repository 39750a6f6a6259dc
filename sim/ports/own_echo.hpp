// Tells an adapter's echo from what others send.
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>

namespace ex9000::sim {

/// Some adapters hear what they send. A module ignores that (wire.md section 9), and would otherwise obey its
/// own replies: that to a Modbus function 05 is the request once more. On two wires nobody else can be heard
/// in that time.
class OwnEcho {
 public:
  using Clock = std::chrono::steady_clock;

  explicit OwnEcho(std::uint32_t baud) : baud_(baud) {}

  void sent(std::size_t bytes, Clock::time_point now) {
    constexpr std::chrono::nanoseconds kCharacterBits{10'000'000'000};
    until_ = std::max(until_, now) + kCharacterBits * static_cast<std::int64_t>(bytes) / baud_;
  }
  /// What is heard at `now` is the echo.
  [[nodiscard]] bool covers(Clock::time_point now) const { return now < until_; }

 private:
  std::int64_t baud_;
  Clock::time_point until_;
};

}  // namespace ex9000::sim
