// What a receiver makes of bytes that were sent at another rate.
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

namespace ex9000::rig {

struct Arrival {
  std::chrono::nanoseconds at;  ///< from the first start bit on
  std::uint8_t byte;
};

/// `bytes`, sent without a gap at `sent_at` bits per second, as a receiver at `heard_at` samples them; none
/// where either is 0. 8N1; framing errors are left out of what is returned, since an emulated UART cannot be
/// given any, but the bytes they came with are in it. Rates that differ by no more than UARTs bear, 2 %, are
/// the same.
std::vector<Arrival> heard_at_rate(const std::vector<std::uint8_t>& bytes, std::uint32_t sent_at,
                                   std::uint32_t heard_at);

/// How long `bytes` take without a gap.
std::chrono::nanoseconds duration_at(std::uint32_t baud, std::size_t bytes);

}  // namespace ex9000::rig
