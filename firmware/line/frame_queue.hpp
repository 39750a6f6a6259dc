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

/// Length of the longest Modbus RTU frame in bytes (Modbus over Serial Line V1.02, 2.5.1). If no built model
/// speaks Modbus: length of the longest accepted DCON frame, without its CR.
constexpr std::size_t kLongestFrame = kBuiltModbus ? 256 : 32;

/// A frame that is being assembled, or a complete frame that waits for the main loop.
struct Frame {
  std::uint16_t offset = 0;  ///< index of the first byte; 1 after a turn-around byte
  std::uint16_t size = 0;    ///< number of bytes from `offset` on, without checksum, CRC and CR
  Time received;             ///< when the UART reported the last byte
  std::array<std::uint8_t, kLongestFrame + 1> storage{};

  [[nodiscard]] Bytes bytes() const { return {storage.data() + offset, size}; }
};

/// Two frame buffers that are used in turn: one frame waits for the main loop while the next one is
/// assembled. The main loop drops a frame before it executes or stores the command of this frame. While the
/// main loop executes or stores the command, the queue can therefore keep one more complete frame. Further
/// frames are lost, and `complete_in_interrupt` returns false for them.
class FrameQueue {
 public:
  /// Returns the frame that is being assembled. Only for the interrupt.
  [[gnu::always_inline]] Frame& assembling() { return frames_[completed_.load() % kFrames]; }

  /// Queues the assembled frame. Returns false if another frame is already waiting; the assembled frame is
  /// then lost. Only for the interrupt.
  [[gnu::always_inline]] bool complete_in_interrupt() {
    if (has_frame()) {
      return false;
    }
    completed_.store_in_interrupt(completed_.load() + 1U);
    return true;
  }

  /// Returns whether a frame is waiting. For interrupts and the main loop.
  [[nodiscard, gnu::always_inline]] bool has_frame() const { return completed_.load() != dropped_.load(); }

  /// Returns the waiting frame, which does not change until it is dropped. For the main loop; call this only
  /// if `has_frame()`.
  [[nodiscard]] const Frame& waiting() const { return frames_[dropped_.load() % kFrames]; }

  /// Removes the waiting frame. For the main loop; call this only if `has_frame()`.
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
