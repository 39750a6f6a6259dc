// Maps each page to the slot of its newest entry.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/flash/entry.hpp"
#include "hal/flash/slot.hpp"

namespace ex9000::hal::flash {

class SlotMap {
 public:
  /// Returns the slot of the newest entry; kNoSlot if no entry of the page is recorded.
  [[nodiscard]] Slot newest(std::size_t page) const { return slots_[page]; }

  /// Records a good entry. Has no effect if a newer entry of this page is already recorded.
  void add(std::size_t page, std::uint32_t sequence, Slot slot) {
    if (slots_[page] == kNoSlot || sequence > sequences_[page]) {
      slots_[page] = slot;
      sequences_[page] = sequence;
    }
  }

  /// Returns whether the newest entry of a page is in this sector.
  [[nodiscard]] bool uses(unsigned sector) const {
    for (const Slot slot : slots_) {
      if (slot != kNoSlot && sector_of(slot) == sector) {
        return true;
      }
    }
    return false;
  }

 private:
  std::array<Slot, kPages> slots_{};
  std::array<std::uint32_t, kPages> sequences_{};
};

}  // namespace ex9000::hal::flash
