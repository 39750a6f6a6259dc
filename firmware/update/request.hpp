// What a Modbus request asks of the update (extensions.md, firmware update).
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/update/slot.hpp"

namespace ex9000::update {

/// The values from Activate on are those of register 0x1013.
enum class Ask : std::uint8_t { Nothing, Activate, Confirm, Abandon, Begin, Block };

struct Request {
  Ask ask = Ask::Nothing;
  Bytes
      data;  ///< of Begin and Block: kInfoSize or kBlockMessageSize bytes, valid until the request is judged
};

/// A block on the line: offset in the image, kBlockSize bytes, CRC-32 of both.
constexpr std::size_t kBlockDataAt = 4;
constexpr std::size_t kBlockCheckAt = kBlockDataAt + kBlockSize;
constexpr std::size_t kBlockMessageSize = kBlockCheckAt + 4;

}  // namespace ex9000::update
