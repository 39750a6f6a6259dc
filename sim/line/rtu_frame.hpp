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

/// Returns whether a frame of at least five bytes has the length that its function code, and the number of
/// bytes in it, require (MODBUS Application Protocol V1.1b3, section 6). Other functions may have any length.
inline bool has_length_of_a_reply(Bytes frame) {
  constexpr std::size_t kAddressFunctionAndCrc = 4;
  const std::uint8_t function = frame[1];
  if ((function & kRtuException) != 0) {
    return frame.size == kAddressFunctionAndCrc + 1;
  }
  switch (function) {
    case 0x01:
    case 0x02:
    case 0x03:
    case 0x04:
      return frame.size == kAddressFunctionAndCrc + 1U + frame[2];
    case 0x05:
    case 0x06:
    case 0x0F:
    case 0x10:
      return frame.size == kAddressFunctionAndCrc + 4;
    default:
      return true;
  }
}

/// Returns whether `frame` is a valid reply, perhaps an exception, to a request with this address and
/// function code. The length tells a reply from the echo of a request that reads.
inline bool is_rtu_reply(std::uint8_t address, std::uint8_t function, Bytes frame) {
  constexpr std::size_t kLeastSize = 5;  // an exception
  return frame.size >= kLeastSize && crc16(frame).value() == 0 && frame[0] == address &&
         (frame[1] | kRtuException) == (function | kRtuException) && has_length_of_a_reply(frame);
}

}  // namespace ex9000::sim
