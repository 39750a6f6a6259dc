// Calculates what a receiver gets if the sender uses another baud rate or another line format.
#pragma once

#include <chrono>
#include <cstdint>
#include <vector>

#include "firmware/line/verdict.hpp"
#include "hal/serial_mode.hpp"

namespace ex9000::rig {

using hal::SerialMode;

struct Arrival {
  std::chrono::nanoseconds at;  ///< time since the first start bit
  std::uint8_t byte;
  ByteStatus status;
};

/// Returns the bytes that a receiver in the mode `heard_in` gets if `bytes` are sent without gaps in the mode
/// `sent_in`. Returns nothing if one of the rates is 0. Rates that differ by at most 2 %, the tolerance of
/// UARTs, count as equal.
std::vector<Arrival> heard_in_mode(const std::vector<std::uint8_t>& bytes, SerialMode sent_in,
                                   SerialMode heard_in);

/// Returns the duration of `bytes` characters without gaps.
std::chrono::nanoseconds duration_in(SerialMode mode, std::size_t bytes);

}  // namespace ex9000::rig
