// How complete frames cross from the receive interrupt to the main loop.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/line/crossing.hpp"
#include "firmware/model/built.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Longest Modbus RTU frame (Modbus over Serial Line V1.02, 2.5.1); without Modbus, the longest DCON frame
/// that is judged.
constexpr std::size_t kLongestFrame = kBuiltModbus ? 256 : 32;

/// A frame that is for this module and passed its check.
struct Frame {
  std::uint16_t offset = 0;  ///< where its first byte lies: 1 behind a turn-around byte
  std::uint16_t size = 0;    ///< bytes from there on, without checksum, CRC and CR
  Time received;             ///< when its last byte was complete
  std::array<std::uint8_t, kLongestFrame + 1> storage{};

  [[nodiscard]] Bytes bytes() const { return {storage.data() + offset, size}; }
};

/// Two frames that take turns: one waits for the main loop while the next one is assembled. While a command
/// is executed or stored, one more frame is kept; what comes on top of that is lost, and the interrupt is
/// told so.
class FrameQueue {
 public:
  /// Interrupt: the frame that is being assembled.
  [[gnu::always_inline]] Frame& assembling() { return frames_[completed_.load() % kFrames]; }

  /// Interrupt: the assembled frame is complete. False if another one waits already; then this one is lost.
  [[gnu::always_inline]] bool complete_in_interrupt() {
    if (has_frame()) {
      return false;
    }
    completed_.store_in_interrupt(completed_.load() + 1U);
    return true;
  }

  /// Interrupts and main loop: whether a frame waits.
  [[nodiscard, gnu::always_inline]] bool has_frame() const { return completed_.load() != dropped_.load(); }

  /// Main loop, only if one waits: that frame. It stays as it is until it is dropped.
  [[nodiscard]] const Frame& waiting() const { return frames_[dropped_.load() % kFrames]; }

  /// Main loop: done with the waiting frame.
  void drop_in_main_loop() { dropped_.store_in_main_loop(dropped_.load() + 1U); }

 private:
  static constexpr std::uint32_t kFrames = 2;

  WrittenByInterrupt<std::uint32_t> completed_;  ///< how many frames; wraps
  WrittenByMainLoop<std::uint32_t> dropped_;     ///< how many of them the main loop is done with
  std::array<Frame, kFrames> frames_{};
};

}  // namespace ex9000
