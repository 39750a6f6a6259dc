// Keeps the state of each sector, and selects the next sector to write or to erase.
#pragma once

#include <array>
#include <cstdint>

#include "hal/flash/slot.hpp"
#include "hal/flash/slot_map.hpp"

namespace ex9000::hal::flash {

/// The sectors form a ring: sector 0 follows the last sector. The store uses the sectors in the order of the
/// ring, so that they wear out evenly. It skips sectors that hold an entry in force or have failed.
class Sectors {
 public:
  static constexpr unsigned kNone = kSectors;

  enum class State : std::uint8_t {
    Used,    ///< has no mark: was written, or has not been erased completely
    Erased,  ///< erased and marked
    Failed,  ///< its mark cannot be programmed or cleared; not used before the next reset
  };

  void set(unsigned sector, State state) { states_[sector] = state; }

  /// Returns the erased sector to write next; kNone if no sector is erased.
  [[nodiscard]] unsigned next_to_open() const {
    return first([this](unsigned sector) { return states_[sector] == State::Erased; });
  }
  /// Returns the `Used` sector to erase next; kNone if there is none. Skips `current`, which is the sector
  /// that is being written or kNone, and the sectors that hold an entry in force according to `map`.
  [[nodiscard]] unsigned next_to_erase(const SlotMap& map, unsigned current) const {
    return first([&](unsigned sector) {
      return states_[sector] == State::Used && sector != current && !map.uses(sector);
    });
  }

  /// Records that an erased sector will be written now.
  void open(unsigned sector) {
    set(sector, State::Used);
    begin_after(sector);
  }
  /// Sets the sector that was opened last. `next_to_open` and `next_to_erase` search from the sector after
  /// it.
  void begin_after(unsigned sector) { last_ = sector; }

 private:
  /// Searches the ring, beginning after the sector that was opened last. Returns the first sector for which
  /// `is_suitable` returns true; kNone if there is none.
  template <class IsSuitable>
  [[nodiscard]] unsigned first(IsSuitable is_suitable) const {
    for (unsigned i = 1; i <= kSectors; ++i) {
      const unsigned sector = (last_ + i) % kSectors;
      if (is_suitable(sector)) {
        return sector;
      }
    }
    return kNone;
  }

  std::array<State, kSectors> states_{};
  unsigned last_ = kSectors - 1;
};

}  // namespace ex9000::hal::flash
