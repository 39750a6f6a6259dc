// Assembles Modbus RTU frames from received bytes and silences in interrupts.
#pragma once

#include <cstdint>

#include "firmware/crossing.hpp"
#include "firmware/line/crc16.hpp"
#include "firmware/line/frame_queue.hpp"
#include "firmware/line/timing.hpp"
#include "firmware/line/verdict.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Frame format: address, function, data, CRC, then a silence of T3.5 - wire.md section 7.
///
/// The silence timer detects the end of a silence. If the interrupt of this timer and the receive interrupt
/// are both pending, the interrupt of the timer must run first (hal/one_shot_timer.hpp).
class RtuAssembler {
 public:
  void use(const LineTiming& timing) { timing_ = timing; }
  [[nodiscard]] const LineTiming& timing() const { return timing_; }
  /// Sets the module's address for all frames that end after this call. For the main loop, which may call
  /// this while bytes are received.
  void answer_to(std::uint8_t address) { own_address_.store_in_main_loop(address); }

  /// Processes a byte that the UART reports at `now`. Restart the silence timer with `rtu_silence` after this
  /// call. Returns the verdict on the previous frame if this byte shows that the previous frame has ended,
  /// else Open. Call this from the receive interrupt.
  Verdict byte(FrameQueue& queue, std::uint8_t byte, ByteStatus status, Time now);

  /// Call this when the silence timer has expired. After this call, restart the timer with `next_wait()`,
  /// unless that time is 0. Returns the verdict on the frame that has ended, or Open if none has ended. An
  /// accepted frame contains address, function and data, but neither the CRC nor a leading turn-around byte
  /// 00. Call this from the interrupt of the silence timer.
  Verdict silence(FrameQueue& queue);
  /// Returns the time after which `silence` must be called again; 0 if this is not necessary.
  [[nodiscard]] Duration next_wait() const;

  /// Call this when the module's own driver is off again. A frame that lacks only its silence is judged; any
  /// other open frame is dropped (wire.md D9). Returns the verdict, or Open if no frame was open or the frame
  /// is dropped. For interrupts.
  Verdict cut_off(FrameQueue& queue);

  /// Returns whether the last correct frame for this module or for all modules was a broadcast. For
  /// interrupts.
  [[nodiscard]] bool last_was_broadcast() const { return broadcast_; }
  /// Returns the end of the silence after the last byte.
  [[nodiscard]] Time silent_since() const { return last_ + timing_.rtu_silence; }

 private:
  enum class State : std::uint8_t {
    Idle,         ///< no frame is open
    Receiving,    ///< a frame is open, and T3.5 is not over
    GracePeriod,  ///< T3.5 is over but the frame is not valid; a byte that began during T3.5 may still arrive
  };

  static constexpr std::uint8_t kTurnAround = 0x00;

  void open();
  void spoil();
  void append(Frame& frame, std::uint8_t byte);
  Verdict conclude(FrameQueue& queue);
  [[nodiscard]] Verdict loss_verdict() const;

  WrittenByMainLoop<std::uint32_t> own_address_;
  LineTiming timing_{};
  State state_ = State::Idle;
  std::uint32_t received_ = 0;  ///< number of bytes of the open frame, including those that did not fit
  bool first_spoiled_ = false;  ///< the first byte had a line error, or the gap after it was too long
  bool rest_spoiled_ = false;   ///< the same for any other byte
  bool overrun_ = false;        ///< one of these line errors was an overrun
  Crc16 whole_;                 ///< CRC of all bytes
  Crc16 crc_after_first_;       ///< CRC of all bytes except the first; valid only if the first is 00
  Time last_;                   ///< when the UART reported the last byte
  bool broadcast_ = false;      ///< the value of `last_was_broadcast`
};

// `byte`, `open`, `spoil` and `append` are inline, because `byte` runs for each byte on the line, including
// bytes for other modules.

inline Verdict RtuAssembler::byte(FrameQueue& queue, std::uint8_t byte, ByteStatus status, Time now) {
  Verdict before = Verdict::Open;
  const Duration gap = now.since(last_);
  last_ = now;
  if (state_ == State::GracePeriod && !(gap < timing_.rtu_silence + timing_.rtu_grace)) {
    before = loss_verdict();  // the byte began after T3.5, but the timer interrupt has not run yet
    state_ = State::Idle;
  }
  if (state_ == State::Idle) {
    open();
  } else if (timing_.rtu_slack < gap) {
    spoil();
  }
  state_ = State::Receiving;
  append(queue.assembling(), byte);
  if (status != ByteStatus::Good) {
    spoil();
    overrun_ = overrun_ || status == ByteStatus::Overrun;
  }
  return before;
}

inline void RtuAssembler::open() {
  received_ = 0;
  first_spoiled_ = false;
  rest_spoiled_ = false;
  overrun_ = false;
  whole_ = Crc16();
  crc_after_first_ = Crc16();
}

/// Marks the last byte, or the gap after it, as faulty.
inline void RtuAssembler::spoil() {
  if (received_ == 1) {
    first_spoiled_ = true;
  } else {
    rest_spoiled_ = true;
  }
}

inline void RtuAssembler::append(Frame& frame, std::uint8_t byte) {
  const std::uint32_t position = received_;
  received_ = position + 1;
  whole_.add(byte);
  if (position != 0 && frame.storage[0] == kTurnAround) {
    crc_after_first_.add(byte);
  }
  if (position < frame.storage.size()) {
    frame.storage[position] = byte;
  }
}

}  // namespace ex9000
