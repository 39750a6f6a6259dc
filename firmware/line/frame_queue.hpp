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

  /// Whether a frame may have so many bytes that count. What is only announced may have fewer, or more.
  static constexpr bool is_size(std::size_t size) {
    constexpr std::size_t kShortest = 2;
    constexpr std::size_t kLongest = kBuiltModbus ? kLongestFrame - 2 : kLongestFrame;
    return size - kShortest <= kLongest - kShortest;
  }
};

/// One frame waits while the next is being assembled: while a command is executed or stored, one more is
/// kept. What comes on top of that is lost, and the interrupt is told so.
///
/// A frame is announced when its check comes out right, and complete when the silence behind it says that
/// this was its end; where the check stands at a CR, that is one moment. The main loop may judge a frame as
/// soon as it is announced, but do nothing else about it before it is complete.
class FrameQueue {
 public:
  /// Interrupt: where the frame that is coming in is assembled; always there.
  [[gnu::always_inline]] Frame& assembling() { return *reinterpret_cast<Frame*>(place_of_frames() + at_); }

  /// Interrupt: the assembled frame would be right if nothing came behind it. It gets a number of its own.
  [[gnu::always_inline]] void announce_in_interrupt(Frame& assembled) {
    coming_.store_in_interrupt(&assembled);
    announced_.store_in_interrupt(announced_.load() + 1U);
  }

  /// Interrupt: the assembled frame, which was announced last, is complete. False where one is waiting
  /// already; then this one is lost.
  [[gnu::always_inline]] bool complete_in_interrupt(Frame& assembled) {
    if (has_frame()) {
      return false;
    }
    waiting_.store_in_interrupt(&assembled);
    at_ ^= sizeof(Frame);
    completed_.store_in_interrupt(announced_.load());
    return true;
  }

  /// Whether a frame waits.
  [[nodiscard, gnu::always_inline]] bool has_frame() const { return completed_.load() != dropped_.load(); }
  /// Main loop: that frame, where one does. It stays until it is dropped.
  [[nodiscard]] const Frame& completed() const { return *waiting_.load(); }
  /// Main loop: its number.
  [[nodiscard]] std::uint32_t waiting_number() const { return completed_.load(); }

  /// The number of the latest frame that was announced; numbers count up and wrap. Whoever reads
  /// `coming` behind it and later finds a frame with this number complete has read that one as it is.
  [[nodiscard, gnu::always_inline]] std::uint32_t announced() const { return announced_.load(); }
  /// Main loop: that frame, once there was one. It may be changed at any moment, so its `bytes()` are asked
  /// for once, and their size is looked at before they are.
  [[nodiscard]] const Frame& coming() const { return *coming_.load(); }

  /// Main loop: done with the waiting frame.
  void drop_in_main_loop() { dropped_.store_in_main_loop(completed_.load()); }

 private:
  std::uint8_t* place_of_frames() { return reinterpret_cast<std::uint8_t*>(frames_.data()); }

  std::uint32_t at_ = 0;                     // interrupt: where the one is that is assembled, in bytes
  WrittenByInterrupt<const Frame*> coming_;  ///< the one that was announced last
  WrittenByInterrupt<std::uint32_t> announced_;
  WrittenByInterrupt<const Frame*> waiting_;     ///< the one that was completed last
  WrittenByInterrupt<std::uint32_t> completed_;  ///< its number
  WrittenByMainLoop<std::uint32_t> dropped_;     ///< likewise of the one that was dropped last
  std::array<Frame, 2> frames_;
};

}  // namespace ex9000
