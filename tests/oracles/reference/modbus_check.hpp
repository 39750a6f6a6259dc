// The CRC of Modbus frames: wire.md 7.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"

namespace ex9000::reference {

/// Returns whether the frame has at least 4 bytes and a correct CRC.
inline bool crc_is_right(const std::vector<std::uint8_t>& frame) {
  return frame.size() >= 4 && with_crc({frame.begin(), frame.end() - 2}) == frame;
}

}  // namespace ex9000::reference
