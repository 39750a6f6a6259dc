// What the module asks of its image slots, and what it knows about them at a reset. See hal/image_slots.hpp.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "firmware/bytes.hpp"
#include "firmware/update/slot.hpp"

namespace ex9000::update {

/// Erase: the sector that begins at `offset`. Program: `source`, which crosses no end of a page of 256 bytes,
/// changes only ones to zeros; up to kBlockSize bytes. Read: to `destination`, at most kBlockSize bytes.
struct SlotJob {
  enum class Kind : std::uint8_t { Erase, Program, Read };

  Kind kind = Kind::Read;
  std::uint8_t slot = 0;
  std::uint32_t offset = 0;  ///< in the slot, in bytes
  Bytes source;              ///< both valid until the job has ended
  MutableBytes destination;
};

/// Of the running image.
struct Origin {
  std::uint8_t slot = 0;
  std::string_view board;  ///< in signatures, at most 4 characters, e.g. "pico"
  std::array<Bytes, kSlots>
      heads{};  ///< kSlotHeadSize bytes each, as at the reset; empty: there are no slots
};

}  // namespace ex9000::update
