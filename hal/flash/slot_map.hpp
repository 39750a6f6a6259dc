// Maps each page of the store to the slot of the newest entry of the page. This is the entry with the highest
// sequence.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "hal/flash/entry.hpp"
#include "hal/flash/slot.hpp"

namespace ex9000::hal::flash {

class SlotMap {
 public:
  /// Returns the slot of the newest entry of `page`; kNoSlot if no entry of `page` is recorded.
  [[nodiscard]] Slot newest(std::size_t page) const { return slots_[page]; }

  /// Records the slot of a good entry of `page`; see `is_good`. Has no effect if an entry of `page` with the
  /// same or a higher sequence is already recorded.
  void add(std::size_t page, std::uint32_t sequence, Slot slot) {
    if (slots_[page] == kNoSlot || sequence > sequences_[page]) {
      slots_[page] = slot;
      sequences_[page] = sequence;
    }
  }

  /// Returns whether `sector` contains the newest entry of any page.
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
