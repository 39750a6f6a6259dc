// The places for entries in the flash.
#pragma once

#include <cstdint>

#include "hal/flash.hpp"
#include "hal/flash/entry.hpp"

namespace ex9000::hal::flash {

/// The number of sectors that the store uses. Each of the 8 pages of the store (entry.hpp) has at most one
/// entry in force, so the entries in force are in at most 8 sectors. The other sectors hold no entry in
/// force. The store can begin to write to one such sector and erase another such sector in advance.
inline constexpr unsigned kSectors = 14;
static_assert(kSectors >= kPages + 2);

/// A slot has room for an entry. Each page of the flash contains five whole slots, so no entry crosses the
/// end of a page of the flash.
inline constexpr unsigned kSlotsOfAFlashPage = 5;
inline constexpr unsigned kSlotSize = 48;
inline constexpr unsigned kSlotsOfASector = kFlashSector / kFlashPage * kSlotsOfAFlashPage;
inline constexpr unsigned kSlots = kSectors * kSlotsOfASector;
static_assert(kEntrySize <= kSlotSize && kSlotsOfAFlashPage * kSlotSize <= kFlashPage);

/// The number of a slot, 0 to kSlots - 1. The first slot of each sector is for the mark of the sector.
using Slot = std::uint16_t;
/// The value that means "no slot". Slot 0 never holds an entry, because it is for a mark.
inline constexpr Slot kNoSlot = 0;

/// Returns the offset of a slot from the beginning of the first sector, in bytes.
constexpr std::uint32_t offset_of(Slot slot) {
  return slot / kSlotsOfAFlashPage * kFlashPage + slot % kSlotsOfAFlashPage * kSlotSize;
}
constexpr unsigned sector_of(Slot slot) { return slot / kSlotsOfASector; }
constexpr bool is_for_mark(Slot slot) { return slot % kSlotsOfASector == 0; }
constexpr Slot first_slot(unsigned sector) { return static_cast<Slot>(sector * kSlotsOfASector); }
/// Returns the next slot of the same sector; kNoSlot if there is none.
constexpr Slot next_slot(Slot slot) {
  const auto next = static_cast<Slot>(slot + 1U);
  return is_for_mark(next) ? kNoSlot : next;
}

}  // namespace ex9000::hal::flash
