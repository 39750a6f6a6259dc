// The silence that the master keeps before a frame.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/bus/bus.hpp"

namespace ex9000::sim {

class Line;

/// Observes who has sent last, so that modules do not treat two frames as one.
class FrameSpacing final : private BusObserver {
 public:
  /// Observes the bus of `line`, which must outlive this object.
  explicit FrameSpacing(Line& line);

  /// Returns the end of the last byte on the wires.
  [[nodiscard]] VirtualTime last_byte() const { return last_byte_; }
  /// Returns whether the master has sent that byte.
  [[nodiscard]] bool master_was_last() const { return last_speaker_ == 0; }

  /// Returns the time from which a frame to `address`, its first byte, is a frame of its own for the module
  /// at this address. Call this only if another station than the master has sent last. The time may have
  /// passed.
  [[nodiscard]] VirtualTime after_others(std::uint8_t address) const;
  /// Returns the time from which a frame is separate from an earlier frame of the master.
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
