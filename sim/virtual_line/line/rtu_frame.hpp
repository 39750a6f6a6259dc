// Builds the Modbus RTU requests of a master, and checks the replies.
#pragma once

#include <algorithm>
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
  std::vector<std::uint8_t> frame;
  frame.reserve(pdu.size() + 3);
  frame.push_back(address);
  frame.insert(frame.end(), pdu.begin(), pdu.end());
  const Crc16 crc = crc16({frame.data(), frame.size()});
  frame.push_back(crc.low_byte());
  frame.push_back(crc.high_byte());
  return frame;
}

/// Returns the PDU in a frame of at least three bytes.
inline Bytes pdu_of(Bytes frame) { return frame.first(frame.size - 2).from(1); }

/// Returns whether `frame` is a valid reply, perhaps an exception, to `request`. Both begin with the address
/// and end with the CRC. Checks the CRC, the address, the function code, and the length of an exception. If
/// the reply is not an exception, and the function is 01 to 06, 0F or 10 (hex), also checks the length, and
/// the byte count or the repeated part of the request (MODBUS Application Protocol V1.1b3, section 6). These
/// checks reject nearly all echoes of requests with functions 01 to 04, and most late replies to earlier
/// requests.
inline bool is_rtu_reply(Bytes request, Bytes frame) {
  constexpr std::size_t kException = 5;        // size of an exception; no reply is shorter
  constexpr std::size_t kAddressAndCount = 8;  // minimum size of a request that reads or writes
  if (frame.size < kException || crc16(frame).value() != 0 || frame[0] != request[0] ||
      (frame[1] | kRtuException) != (request[1] | kRtuException)) {
    return false;
  }
  const std::uint8_t function = frame[1];
  if ((function & kRtuException) != 0) {
    return frame.size == kException;
  }
  const bool reads_bits = function == 0x01 || function == 0x02;
  const bool reads_words = function == 0x03 || function == 0x04;
  const bool writes = function == 0x05 || function == 0x06 || function == 0x0F || function == 0x10;
  if (!reads_bits && !reads_words && !writes) {
    return true;
  }
  if (request.size < kAddressAndCount) {
    return false;
  }
  if (writes) {  // the reply repeats the data address, and the value or the count
    return frame.size == kAddressAndCount && std::equal(frame.begin(), frame.begin() + 6, request.begin());
  }
  const std::size_t count = request.word(4);
  const std::size_t bytes = reads_bits ? (count + 7) / 8 : 2 * count;
  return frame[2] == bytes && frame.size == kException + bytes;
}

}  // namespace ex9000::sim
