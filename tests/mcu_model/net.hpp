// A wire and all that pulls at it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <utility>
#include <vector>

namespace ex9000::registers {

/// What one end does to a wire.
enum class Drive : std::uint8_t { Nothing, WeakLow, WeakHigh, Low, High };

/// Who may pull at a wire.
enum class End : std::uint8_t {
  Microcontroller,  ///< its output stage
  WeakPull,         ///< its own pull-up or pull-down
  Board,            ///< what is wired to it
  Resistor,         ///< a pull-up or pull-down on the board; stronger than the microcontroller's own
  Device,           ///< a chip beside it
  Fault,            ///< what should not be there: a short, a chip that hangs
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

  /// Told after each change of the level. Lives as long as the wire, so what it refers to must, too.
  void on_change(std::function<void()> act) { on_change_.push_back(std::move(act)); }

  /// Two ends have driven it hard against each other, ever.
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
