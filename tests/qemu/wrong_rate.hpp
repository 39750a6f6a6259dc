// Calculates which bytes a receiver samples if the sender uses another baud rate.
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

namespace ex9000::rig {

struct Arrival {
  std::chrono::nanoseconds at;  ///< time since the first start bit
  std::uint8_t byte;
};

/// Returns the bytes that a receiver at `heard_at` samples if `bytes` are sent without gaps at `sent_at` bits
/// per second. Returns nothing if one of the rates is 0. The format is 8N1. A byte with a framing error is
/// returned like others, because an emulated UART cannot receive a framing error. Rates that differ by at
/// most 2 %, the tolerance of UARTs, count as equal.
std::vector<Arrival> heard_at_rate(const std::vector<std::uint8_t>& bytes, std::uint32_t sent_at,
                                   std::uint32_t heard_at);

/// Returns the duration of `bytes` characters without gaps.
std::chrono::nanoseconds duration_at(std::uint32_t baud, std::size_t bytes);

}  // namespace ex9000::rig
