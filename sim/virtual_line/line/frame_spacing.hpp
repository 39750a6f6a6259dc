// Calculates when the master may begin a frame.
#pragma once

#include <cstddef>
#include <cstdint>

#include "sim/virtual_line/wires/wires.hpp"

namespace ex9000::sim {

class Line;

/// Observes who has sent last: modules must not treat two frames as one. Valid only while `line` exists.
class FrameSpacing final : private WireObserver {
 public:
  explicit FrameSpacing(Line& line);

  /// The end of the last complete byte, with a second stop bit; 0: none yet.
  [[nodiscard]] VirtualTime last_byte() const { return last_byte_; }
  /// Also true if no byte is complete yet.
  [[nodiscard]] bool master_was_last() const { return last_speaker_ == 0; }

  /// The earliest start, perhaps in the past, of a frame that begins with `address`: sooner, the addressed
  /// modules may join it to the previous frame. Only if `!master_was_last()`.
  [[nodiscard]] VirtualTime after_others(std::uint8_t address) const;
  /// The same after a frame of the master: only if `master_was_last()`.
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
