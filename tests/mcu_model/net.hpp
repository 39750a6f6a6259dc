// A wire and the ends that can drive it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace ex9000::registers {

/// How one end drives a wire.
enum class Drive : std::uint8_t { Nothing, WeakLow, WeakHigh, Low, High };

/// The ends that can drive a wire.
enum class End : std::uint8_t {
  Microcontroller,  ///< the output stage of the microcontroller
  WeakPull,         ///< the weak pull-up or pull-down of the microcontroller
  Board,            ///< a signal from outside, for example of a switch or of the transceiver
  Resistor,         ///< a pull-up or pull-down on the board; stronger than the microcontroller's own
  Device,           ///< the EEPROM
  Fault,            ///< a defect, for example a short circuit or a chip that hangs
};

class Net {
 public:
  void drive(End end, Drive drive) {
    ends_[static_cast<std::size_t>(end)] = drive;
    const bool before = level_;
    level_ = resolve();
    if (level_ != before) {
      for (const auto& each : on_change_) {
        each();
      }
    }
  }
  [[nodiscard]] Drive driven_by(End end) const { return ends_[static_cast<std::size_t>(end)]; }
  [[nodiscard]] bool level() const { return level_; }

  /// Adds a function to call after each change of the level. Everything that the function refers to must live
  /// until the last change of the level.
  void on_change(std::function<void()> act) { on_change_.push_back(std::move(act)); }

  /// Returns whether two ends have ever driven the wire to opposite levels (Low and High) at the same time.
  [[nodiscard]] bool was_shorted() const { return was_shorted_; }

 private:
  static constexpr std::size_t kEnds = 6;

  [[nodiscard]] bool any(Drive drive) const {
    for (const Drive end : ends_) {
      if (end == drive) {
        return true;
      }
    }
    return false;
  }

  bool resolve() {
    const bool low = any(Drive::Low);
    const bool high = any(Drive::High);
    was_shorted_ = was_shorted_ || (low && high);
    if (low || high) {
      return !low;
    }
    const Drive resistor = driven_by(End::Resistor);
    const Drive weak = resistor != Drive::Nothing ? resistor : driven_by(End::WeakPull);
    return weak == Drive::WeakHigh;
  }

  std::array<Drive, kEnds> ends_{};
  bool level_ = false;
  bool was_shorted_ = false;
  std::vector<std::function<void()>> on_change_;
};

}  // namespace ex9000::registers
