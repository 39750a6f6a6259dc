// Assembles Modbus RTU frames from bytes and silences, in interrupts.
#pragma once

#include <cstdint>

#include "firmware/crossing.hpp"
#include "firmware/line/arbitration.hpp"
#include "firmware/line/crc16.hpp"
#include "firmware/line/frame_queue.hpp"
#include "firmware/line/timing.hpp"
#include "firmware/line/verdict.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Address, function, data, CRC, then a silence of T3.5 - wire.md section 7. The silence timer detects the
/// silence and supplies the time, so that a byte needs no clock. If this timer and the receive interrupt are
/// both pending, the timer must run first (hal/one_shot_timer.hpp).
class RtuAssembler {
 public:
  void use(const LineTiming& timing);
  [[nodiscard]] const LineTiming& timing() const { return timing_; }
  /// For frames that end after this call. For the main loop, also while bytes are received.
  void answer_to(std::uint8_t address) { own_address_.store_in_main_loop(address); }
  /// The same for frames that are addressed by serial number. 0: the module has none.
  void answer_to_number(std::uint32_t serial_number) { serial_number_.store_in_main_loop(serial_number); }

  /// From the receive interrupt; then restart the silence timer with the returned time, unless it is 0: a
  /// byte of an arbitration.
  Duration byte(FrameQueue& queue, std::uint8_t byte, ByteStatus status);
  /// After `byte`: the frame asks for a round of a scan if it ends here, which it does when its first wait is
  /// over.
  [[nodiscard]] bool asks_for_round() const { return round() != Arbitration::Round::None; }

  /// From the interrupt of the silence timer, unless the arbitration is active; then restart it with
  /// `next_wait()`, unless that is 0. Returns the verdict on the frame that has ended, or Open. An accepted
  /// frame is address, function and data, without the CRC and a leading turn-around byte 00. A frame that
  /// asks for a round of a scan begins the arbitration.
  Verdict silence(FrameQueue& queue, Time now);
  [[nodiscard]] Duration next_wait() const;

  /// From an interrupt, when the module's own driver is off again. Judges a frame that lacks only its
  /// silence; drops any other (wire.md D9). Open if none was open or it is dropped.
  Verdict cut_off(FrameQueue& queue, Time now);

  Arbitration& arbitration() { return arbitration_; }
  [[nodiscard]] const Arbitration& arbitration() const { return arbitration_; }

  /// Whether the last correct frame for this module or for all was a broadcast. For interrupts.
  [[nodiscard]] bool last_was_broadcast() const { return broadcast_; }

 private:
  enum class State : std::uint8_t {
    Idle,         ///< no frame is open
    Receiving,    ///< a frame is open, and its first wait is not over
    LongGap,      ///< T3.5 is not over; if gaps are limited, the next byte makes the frame invalid
    GracePeriod,  ///< T3.5 is over but the frame is not valid; a byte that began during T3.5 may still arrive
  };

  static constexpr std::uint8_t kTurnAround = 0x00;

  /// A gap between two bytes can make a frame invalid.
  [[nodiscard]] bool strict() const { return timing_.rtu_slack < timing_.rtu_silence; }
  void open(FrameQueue& queue, std::uint8_t first);
  bool go_on(FrameQueue& queue, std::uint8_t byte);
  void spoil();
  [[nodiscard]] Arbitration::Round round() const;
  bool begin_round(Time now);
  [[nodiscard]] bool has_own_number(const std::uint8_t* frame, unsigned size) const;
  Verdict conclude(FrameQueue& queue, Time received);
  [[nodiscard]] Verdict loss_verdict() const;

  WrittenByMainLoop<std::uint32_t> own_address_;
  WrittenByMainLoop<std::uint32_t> serial_number_;
  LineTiming timing_{};
  Duration usual_wait_;
  Duration wait_if_round_;  ///< of a frame that may ask for a round of a scan
  Duration first_wait_;     ///< of the open frame
  State state_ = State::Idle;
  Frame* frame_ = nullptr;          ///< the open frame
  std::uint32_t received_ = 0;      ///< number of bytes of the open frame, including those that did not fit
  bool may_ask_for_round_ = false;  ///< by its first byte, at the end of the open frame
  bool after_zero_ = false;         ///< the first byte is 00, which may be a turn-around byte
  bool first_spoiled_ = false;      ///< the first byte had a line error, or the gap after it was too long
  bool rest_spoiled_ = false;       ///< the same for any other byte
  bool overrun_ = false;            ///< one of these line errors was an overrun
  Crc16 whole_;                     ///< CRC of all bytes
  Crc16 crc_after_zero_;            ///< CRC of all bytes except the first; valid only if `after_zero_`
  bool broadcast_ = false;          ///< the value of `last_was_broadcast`
  Arbitration arbitration_;
};

// `byte` and `spoil` are inline, because `byte` runs for each byte on the line, also of other modules.

inline Duration RtuAssembler::byte(FrameQueue& queue, std::uint8_t byte, ByteStatus status) {
  if (state_ != State::Receiving) {
    if (!go_on(queue, byte)) {
      return {};
    }
  } else if (after_zero_) {
    crc_after_zero_.add(byte);
  }
  whole_.add(byte);
  const std::uint32_t position = received_;
  received_ = position + 1;
  if (position < frame_->storage.size()) {
    frame_->storage[position] = byte;
  }
  if (status != ByteStatus::Good) {
    spoil();
    overrun_ = overrun_ || status == ByteStatus::Overrun;
  }
  return first_wait_;
}

/// The last byte, or the gap after it.
inline void RtuAssembler::spoil() {
  if (received_ == 1) {
    first_spoiled_ = true;
  } else {
    rest_spoiled_ = true;
  }
}

}  // namespace ex9000
