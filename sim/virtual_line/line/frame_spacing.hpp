// Calculates when the master may begin a frame.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/virtual_line/wires/wires.hpp"

namespace ex9000::sim {

class Line;

/// Observes which station has sent last, so that the master can begin a frame late enough: modules must not
/// treat two frames as one.
class FrameSpacing final : private WireObserver {
 public:
  /// Observes Wires of `line`. Use this object only while `line` exists.
  explicit FrameSpacing(Line& line);

  /// Returns the end of the last complete byte on the wires, including a second stop bit; 0 if no byte is
  /// complete yet.
  [[nodiscard]] VirtualTime last_byte() const { return last_byte_; }
  /// Returns whether the master has sent the last complete byte. Also returns true if no byte is
  /// complete yet.
  [[nodiscard]] bool master_was_last() const { return last_speaker_ == 0; }

  /// Returns the earliest time at which the master may begin a frame. If the frame begins earlier, the
  /// addressed modules may join it to the previous frame. `address` is the first byte of the frame. The
  /// returned time may be in the past. Call this only if `master_was_last()` is false.
  [[nodiscard]] VirtualTime after_others(std::uint8_t address) const;
  /// Returns the earliest time at which the master may begin a frame. If the frame begins earlier, modules
  /// may join it to the previous frame of the master. Call this only if `master_was_last()` is true.
  [[nodiscard]] VirtualTime after_own() const;

 private:
  [[nodiscard]] bool is_for_modbus(std::uint8_t address) const;
  void byte(std::size_t station, std::uint8_t byte, SerialMode mode, bool collided, VirtualTime start,
            VirtualTime end) override;

  const Line& line_;
  std::size_t last_speaker_ = 0;  ///< the station that has sent last; 0: the master, or no station yet
  VirtualTime last_byte_{0};
};

}  // namespace ex9000::sim
