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

/// `frame`: at least three bytes.
inline Bytes pdu_of(Bytes frame) { return frame.first(frame.size - 2).from(1); }

/// Size of a reply that is no exception; 0: `request` is too short, or no function 01 to 06, 0F, 10 (hex).
inline std::size_t rtu_reply_size(Bytes request) {
  constexpr std::size_t kAddressAndCount = 8;  // minimum size of a request that reads or writes
  constexpr std::size_t kWithoutData = 5;      // address, function, byte count, CRC
  if (request.size < kAddressAndCount) {
    return 0;
  }
  const std::size_t count = request.word(4);
  switch (request[1]) {
    case 0x01:
    case 0x02:
      return kWithoutData + (count + 7) / 8;
    case 0x03:
    case 0x04:
      return kWithoutData + 2 * count;
    case 0x05:
    case 0x06:
    case 0x0F:
    case 0x10:
      return kAddressAndCount;
    default:
      return 0;
  }
}

/// Both begin with the address and end with the CRC. Checks the CRC, the address, the function code and the
/// length of an exception; for functions 01 to 06, 0F and 10 (hex) also the length, and the byte count or
/// what the reply repeats (MODBUS Application Protocol V1.1b3, section 6). This rejects nearly all echoes of
/// functions 01 to 04, and most late replies to earlier requests.
inline bool is_rtu_reply(Bytes request, Bytes frame) {
  constexpr std::size_t kException = 5;  // size of an exception; no reply is shorter
  if (frame.size < kException || crc16(frame).value() != 0 || frame[0] != request[0] ||
      (frame[1] | kRtuException) != (request[1] | kRtuException)) {
    return false;
  }
  const std::uint8_t function = frame[1];
  if ((function & kRtuException) != 0) {
    return frame.size == kException;
  }
  const bool reads = function >= 0x01 && function <= 0x04;
  const bool writes = function == 0x05 || function == 0x06 || function == 0x0F || function == 0x10;
  if (!reads && !writes) {
    return true;
  }
  if (frame.size != rtu_reply_size(request)) {
    return false;
  }
  return reads ? frame[2] + kException == frame.size
               // the reply repeats the data address, and the value or the count
               : std::equal(frame.begin(), frame.begin() + 6, request.begin());
}

}  // namespace ex9000::sim
