// The head of slot 0 in an image that is copied over USB or written by a debug probe: it may start at once.
// Include this file in only one source file of a program, after the `board.hpp` of a board.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/model/built.hpp"
#include "firmware/update/signature.hpp"
#include "firmware/update/slot.hpp"

namespace ex9000::board {

/// toolchain/seal-image adds length and CRC of the image, and the CRC of the header.
constexpr update::SlotHead unsealed_slot_head() {
  constexpr std::size_t kSignature = update::kInfoAt;
  constexpr std::size_t kVersion = update::kInfoAt + update::kVersionAt;
  constexpr unsigned kBitsOfAByte = 8;
  constexpr auto kImageFor = update::signature_of(kOnlyModel, kBoardCode);
  update::SlotHead head{};  // all marks are set
  std::size_t at = 0;
  for (const char character : update::kMagic) {
    head[at++] = static_cast<std::uint8_t>(character);
  }
  head[update::kSequenceAt + 3] = 1;
  for (std::size_t i = 0; i < kImageFor.size(); ++i) {
    head[kSignature + i] = kImageFor[i];
  }
  head[kVersion] = static_cast<std::uint8_t>(version_in_bcd() >> kBitsOfAByte);
  head[kVersion + 1] = static_cast<std::uint8_t>(version_in_bcd());
  return head;
}

// NOLINTNEXTLINE(misc-definitions-in-headers): included once
__attribute__((section(".slot_head"), used)) constexpr update::SlotHead kSlotHead = unsealed_slot_head();

}  // namespace ex9000::board
