#pragma once

#include "hal/image_slots.hpp"

namespace ex9000::hal::doubles {

/// For a board without slots, in a program whose module could use them.
struct NoImageSlots {
  [[nodiscard]] static update::Origin origin() { return {}; }
  static void start(const update::SlotJob& /*job*/, Time /*now*/) {}
  static bool poll(Time /*now*/) { return false; }
  [[nodiscard]] static bool busy() { return false; }
};

}  // namespace ex9000::hal::doubles
