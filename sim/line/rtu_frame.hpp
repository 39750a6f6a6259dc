// Modbus RTU frames of a master.
#pragma once

#include <cstdint>
#include <vector>

#include "firmware/bytes.hpp"
#include "firmware/line/crc16.hpp"

namespace ex9000::sim {

constexpr std::uint8_t kRtuBroadcast = 0;
constexpr std::uint8_t kLastRtuAddress = 247;
constexpr std::uint8_t kRtuException = 0x80;  ///< this bit of the function code marks an exception

/// Returns the frame with this address and PDU.
inline std::vector<std::uint8_t> rtu_frame(std::uint8_t address, const std::vector<std::uint8_t>& pdu) {
  std::vector<std::uint8_t> frame{address};
  frame.insert(frame.end(), pdu.begin(), pdu.end());
  const std::uint32_t crc = crc16({frame.data(), frame.size()}).value();
  frame.push_back(static_cast<std::uint8_t>(crc));
  frame.push_back(static_cast<std::uint8_t>(crc >> 8U));
  return frame;
}

/// Returns the PDU in a frame of at least three bytes.
inline Bytes pdu_of(Bytes frame) { return frame.first(frame.size - 2).from(1); }

/// Returns whether `frame` is a valid reply, perhaps an exception, to a request with this address and
/// function code.
inline bool is_rtu_reply(std::uint8_t address, std::uint8_t function, Bytes frame) {
  constexpr std::size_t kExceptionSize = 5;  // no reply is shorter
  return frame.size >= kExceptionSize && crc16(frame).value() == 0 && frame[0] == address &&
         (frame[1] | kRtuException) == (function | kRtuException);
}

}  // namespace ex9000::sim
