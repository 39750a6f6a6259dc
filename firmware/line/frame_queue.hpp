// Passes complete frames from interrupts to the main loop.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/crossing.hpp"
#include "firmware/expect.hpp"
#include "firmware/model/built.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// In bytes: Modbus RTU (Modbus over Serial Line V1.02, 2.5.1); DCON without CR if Modbus is not built.
constexpr std::size_t kLongestFrame = kBuiltModbus ? 256 : 32;

struct Frame {
  std::uint16_t offset = 0;  ///< index of the first byte; 1 after a turn-around byte
  /// Addressed by serial number: the last byte of the number is the first byte of the frame.
  bool by_serial_number = false;
  std::uint16_t size = 0;  ///< number of bytes from `offset` on, without checksum, CRC and CR
  Time received;           ///< when the UART reported the last byte
  std::array<std::uint8_t, kLongestFrame + 1> storage{};

  [[nodiscard]] Bytes bytes() const { return {storage.data() + offset, size}; }
};

/// Two buffers in turn: one frame waits for the main loop while the next is assembled. The main loop drops a
/// frame before it executes or stores its command, so meanwhile one more frame fits. Further ones are lost.
class FrameQueue {
 public:
  /// For the interrupt.
  [[gnu::always_inline]] Frame& assembling() { return frames_[completed_.load() % kFrames]; }

  /// False if another frame is waiting; the assembled one is then lost.
  [[gnu::always_inline]] bool complete_in_interrupt() {
    if (has_frame()) {
      return false;
    }
    completed_.store_in_interrupt(completed_.load() + 1U);
    return true;
  }

  [[nodiscard, gnu::always_inline]] bool has_frame() const { return completed_.load() != dropped_.load(); }

  /// Unchanged until dropped. For the main loop; like the drop, only if `has_frame()`.
  [[nodiscard]] const Frame& waiting() const { return frames_[dropped_.load() % kFrames]; }

  void drop_in_main_loop() {
    EX9000_EXPECT(has_frame());
    dropped_.store_in_main_loop(dropped_.load() + 1U);
  }

 private:
  static constexpr std::uint32_t kFrames = 2;

  WrittenByInterrupt<std::uint32_t> completed_;  ///< number of frames that were queued; wraps
  WrittenByMainLoop<std::uint32_t> dropped_;     ///< number of frames that the main loop has dropped; wraps
  std::array<Frame, kFrames> frames_{};
};

}  // namespace ex9000
