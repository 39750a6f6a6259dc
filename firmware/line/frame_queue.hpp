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
  Frame& assembling() { return frames_[second_]; }

  /// Interrupt: the assembled frame is complete. False where one is waiting already; then this one is lost.
  bool complete_in_interrupt() {
    const std::uint32_t completed = completed_.load();
    if (completed != dropped_.load()) {
      return false;
    }
    waiting_.store_in_interrupt(&frames_[second_]);
    second_ ^= 1U;
    completed_.store_in_interrupt(completed + 1U);
    return true;
  }

  /// Whether a frame waits.
  [[nodiscard, gnu::always_inline]] bool has_frame() const { return completed_.load() != dropped_.load(); }
  /// Main loop: the frame that waits, or null. It stays until it is dropped.
  [[nodiscard, gnu::always_inline]] const Frame* waiting() const {
    return has_frame() ? waiting_.load() : nullptr;
  }

  /// Main loop: done with the waiting frame.
  void drop_in_main_loop() { dropped_.store_in_main_loop(dropped_.load() + 1U); }

 private:
  std::uint32_t second_ = 0;                  // interrupt: which of the two is assembled
  WrittenByInterrupt<const Frame*> waiting_;  ///< the one that was completed last
  WrittenByInterrupt<std::uint32_t> completed_;
  WrittenByMainLoop<std::uint32_t> dropped_;
  std::array<Frame, 2> frames_;
};

}  // namespace ex9000
