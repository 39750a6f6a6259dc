// Modbus requests and replies for the scenarios. The module has the address 1.
#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"

namespace ex9000::interleaving {

/// Returns the frame with its CRC.
inline std::string rtu(std::vector<std::uint8_t> frame) {
  frame = with_crc(std::move(frame));
  return {frame.begin(), frame.end()};
}

inline const std::string kRtuOn = rtu({1, 0x05, 0, 2, 0xFF, 0});
inline const std::string kRtuRead = rtu({1, 0x01, 0, 0, 0, 13});
inline const std::string kRtuReadReply = rtu({1, 0x01, 2, 0, 0});
inline const std::string kRtuReadOnReply = rtu({1, 0x01, 2, 4, 0});
inline const std::string kRtuStore = rtu({1, 0x06, 1, 0xE5, 0, 9});
inline const std::string kRtuHostOk = rtu({1, 0x03, 0x30, 0x38, 0, 0});
inline const std::string kScan = rtu({0xFD, 0x46, 0x01});
inline const std::string kScanReply = rtu({0xFD, 0x46, 0x03, 0x0D, 0x00, 0xFF, 0xFF, 1});
inline const std::string kRtuProbe = rtu({1, 0x46, 0});
inline const std::string kRtuProbeReply = rtu({1, 0x46, 0, 0, 0x90, 0x42, 0});

}  // namespace ex9000::interleaving
