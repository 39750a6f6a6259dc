// Calculates when the master may begin a frame.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/virtual_line/bus/bus.hpp"

namespace ex9000::sim {

class Line;

/// Observes which station has sent last, so that the master can begin a frame late enough: modules must not
/// treat two frames as one.
class FrameSpacing final : private BusObserver {
 public:
  /// Observes the bus of `line`, which must outlive this object.
  explicit FrameSpacing(Line& line);

  /// Returns the end of the last byte on the wires.
  [[nodiscard]] VirtualTime last_byte() const { return last_byte_; }
  /// Returns whether the master has sent that byte.
  [[nodiscard]] bool master_was_last() const { return last_speaker_ == 0; }

  /// Returns the earliest start of a frame that the module at `address` treats as a separate frame. `address`
  /// is the first byte of the frame. The returned time may be in the past. Call this only if a station other
  /// than the master has sent last.
  [[nodiscard]] VirtualTime after_others(std::uint8_t address) const;
  /// Returns the earliest start of a frame that modules do not join to the previous frame of the master.
  [[nodiscard]] VirtualTime after_own() const;

 private:
  [[nodiscard]] bool is_for_modbus(std::uint8_t address) const;
  void byte(std::size_t station, std::uint8_t byte, SerialMode mode, bool collided, VirtualTime start,
            VirtualTime end) override;

  const Line& line_;
  std::size_t last_speaker_ = 0;  ///< the station that has sent last; 0: the master
  VirtualTime last_byte_{0};
};

}  // namespace ex9000::sim
