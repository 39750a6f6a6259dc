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
  /// Time from the first start bit until the receiver has the byte: the end of the byte if all bytes arrive
  /// unchanged, otherwise the middle of its first stop bit.
  std::chrono::nanoseconds at;
  std::uint8_t byte;
  ByteStatus status;
};

/// Returns the bytes that a receiver in the mode `heard_in` gets if `bytes` are sent without gaps in the mode
/// `sent_in`. Returns no bytes if one of the rates is 0. If the formats match (sim::hear_each_other) and the
/// rates differ by at most 2 %, which UARTs tolerate, all bytes arrive unchanged.
std::vector<Arrival> heard_in_mode(const std::vector<std::uint8_t>& bytes, SerialMode sent_in,
                                   SerialMode heard_in);

/// Returns the duration of `bytes` characters without gaps. The rate must not be 0.
std::chrono::nanoseconds duration_in(SerialMode mode, std::size_t bytes);

}  // namespace ex9000::rig
