// An erase that is suspended while other accesses use the flash.
#pragma once

#include <cstdint>

#include "firmware/time.hpp"
#include "hal/flash.hpp"

namespace ex9000::hal::flash {

/// Call a function of this class only while the flash is not busy, unless the description of the function
/// says otherwise.
template <class Flash>
class BackgroundErase {
 public:
  /// An erase runs at least this long before `suspend` suspends it, so that it always makes progress. A
  /// W25Q16JV requires 20 us; chips of other manufacturers require up to 1 ms.
  static constexpr Duration kShortestRun = milliseconds(1);

  /// Begins to erase a sector. Call it only if no erase is `under_way()`.
  void start(Flash& flash, unsigned sector, std::uint32_t address, Time now) {
    flash.start_erase(address);
    sector_ = sector;
    run(now);
  }

  /// Suspends an erase that was in progress at a reset of the MCU; if there was none, the flash ignores the
  /// command. The flash may be busy. `no_sector`: the value that `sector()` returns afterwards.
  void suspend_unknown(Flash& flash, unsigned no_sector) {
    flash.suspend();
    sector_ = no_sector;
    state_ = State::Suspended;
  }

  /// Suspends a running erase; call this while the flash is busy. Returns whether the flash will be available
  /// within 20 us: false if no erase is under way, or if the erase has run for less than kShortestRun.
  bool suspend(Flash& flash, Time now) {
    if (state_ == State::Running && now.since(began_) < kShortestRun) {
      return false;
    }
    if (state_ == State::Running) {
      flash.suspend();
      state_ = State::Suspended;
    }
    return state_ == State::Suspended;
  }

  [[nodiscard]] bool suspended() const { return state_ == State::Suspended; }
  void resume(Flash& flash, Time now) {
    flash.resume();
    run(now);
  }

  [[nodiscard]] bool under_way() const { return state_ != State::None; }
  /// Returns whether the erase has ended since `start` or `resume`. If it has ended, this call makes
  /// `under_way()` false.
  bool take_end() {
    const bool ended = state_ == State::Running;
    if (ended) {
      state_ = State::None;
    }
    return ended;
  }
  /// Returns the sector of the last erase.
  [[nodiscard]] unsigned sector() const { return sector_; }

 private:
  enum class State : std::uint8_t {
    None,
    Running,
    Suspended,  ///< also if the erase had ended before the command, or `suspend_unknown` found no erase
  };

  void run(Time now) {
    began_ = now;
    state_ = State::Running;
  }

  State state_ = State::None;
  unsigned sector_ = 0;
  Time began_;  ///< the time at which the erase began or was resumed
};

}  // namespace ex9000::hal::flash
