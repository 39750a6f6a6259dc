// How whole frames cross from the receive interrupt to the main loop.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/line/crossing.hpp"
#include "firmware/model/built.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Longest Modbus RTU frame (Modbus over Serial Line V1.02, 2.5.1); without Modbus, longest DCON frame that
/// is judged.
constexpr std::size_t kLongestFrame = kBuiltModbus ? 256 : 32;

/// A frame that is for this module and passed its check.
struct Frame {
  std::uint8_t size = 0;    ///< bytes that count: without checksum, CRC, CR and turn-around byte
  std::uint8_t offset = 0;  ///< where they begin: 1 behind a turn-around byte
  Time received;            ///< when its last byte was complete
  std::array<std::uint8_t, kLongestFrame + 1> storage{};

  [[nodiscard]] Bytes bytes() const { return {storage.data() + offset, size}; }
};

/// One frame waits while the next is being assembled: while a command is executed or stored, one more is
/// kept. What comes on top of that is lost, and the interrupt is told so.
class FrameQueue {
 public:
  /// Interrupt: where the frame that is coming in is assembled; always there.
  [[gnu::always_inline]] Frame& assembling() { return frames_[written_.load() % kFrames]; }

  /// Interrupt: the assembled frame is complete. False where one is waiting already; then this one is lost.
  [[gnu::always_inline]] bool complete_in_interrupt() {
    const std::uint8_t written = written_.load();
    if (static_cast<std::uint8_t>(written - read_.load()) >= kFrames - 1) {
      return false;
    }
    written_.store_in_interrupt(static_cast<std::uint8_t>(written + 1U));
    return true;
  }

  /// Main loop: the frame that waits, or null. It stays until it is dropped.
  [[nodiscard, gnu::always_inline]] const Frame* waiting() const {
    const std::uint8_t read = read_.load();
    return written_.load() == read ? nullptr : &frames_[read % kFrames];
  }

  /// Main loop: done with the waiting frame.
  void drop_in_main_loop() { read_.store_in_main_loop(static_cast<std::uint8_t>(read_.load() + 1U)); }

 private:
  static constexpr std::uint8_t kFrames = 2;

  std::array<Frame, kFrames> frames_;
  WrittenByInterrupt<std::uint8_t> written_;
  WrittenByMainLoop<std::uint8_t> read_;
};

}  // namespace ex9000
