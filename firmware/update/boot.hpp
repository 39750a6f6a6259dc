// Which image starts: the decision of the boot loader.
#pragma once

#include <array>
#include <cstdint>
#include <initializer_list>
#include <optional>

#include "firmware/update/slot.hpp"

namespace ex9000::update {

/// The slot whose image starts; none if both are damaged. `Slots`:
///     SlotHead head(unsigned slot)
///     bool load(unsigned slot, const Info& info)    Copies the image to where it runs. False: it is damaged.
///     bool mark_tried(unsigned slot)                False: the mark does not read back.
/// An image that is not confirmed gets one chance, so it does not start without its mark.
template <class Slots>
std::optional<unsigned> choose(Slots& slots) {
  std::array<Slot, kSlots> all;
  for (unsigned slot = 0; slot < kSlots; ++slot) {
    const auto head = slots.head(slot);
    all[slot] = Slot({head.data(), head.size()});
  }
  const unsigned first = first_choice(all[0], all[1]);
  for (const unsigned slot : {first, 1U - first}) {
    const Slot& each = all[slot];
    if (each.may_start() && slots.load(slot, each.info) && (each.confirmed || slots.mark_tried(slot))) {
      return slot;
    }
  }
  return std::nullopt;
}

}  // namespace ex9000::update
