// Assembles Modbus RTU frames from received bytes and silences. Runs in the receive and timer interrupts.
#pragma once

#include <cstdint>

#include "firmware/line/crc16.hpp"
#include "firmware/line/crossing.hpp"
#include "firmware/line/frame_queue.hpp"
#include "firmware/line/timing.hpp"
#include "firmware/line/verdict.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// address, function, data, CRC, then T3.5 of silence - wire.md section 7.
///
/// A timer ends frames. Its interrupt is served before that of a byte that comes later
/// (hal/one_shot_timer.hpp).
class RtuAssembler {
 public:
  void use(const LineTiming& timing) { timing_ = timing; }
  [[nodiscard]] const LineTiming& timing() const { return timing_; }
  /// Main loop, also while bytes come in: the module's address, for every frame that ends from now on.
  void answer_to(std::uint8_t address) { own_address_.store_in_main_loop(address); }

  /// Receive interrupt: a byte was complete at `now`. Restart the timer with T3.5 after it. Says what became
  /// of the frame before, if the byte shows that it is over.
  Verdict byte(FrameQueue& queue, std::uint8_t byte, ByteStatus status, Time now);

  /// Timer interrupt: the time has passed since the last byte, or since the last call. Restart the timer with
  /// `next_wait()` after it. An accepted frame holds address, function and data: neither the CRC nor a
  /// turn-around 00 before it.
  Verdict silence(FrameQueue& queue);
  /// Zero if nothing is waited for.
  [[nodiscard]] Duration next_wait() const;

  /// Interrupt: the own driver was on. A frame whose CRC is right was whole and is judged, any other is
  /// forgotten (wire.md D9).
  Verdict cut_off(FrameQueue& queue);

  /// When the silence was over that ended the last frame.
  [[nodiscard]] Time silent_since() const { return last_ + timing_.rtu_silence; }

 private:
  enum class State : std::uint8_t {
    Idle,       ///< no frame is open
    Receiving,  ///< the last byte is less than T3.5 old
    Doubtful,   ///< T3.5 have passed and this is no frame: a byte that began in time may still come in
  };

  void open();
  void spoil();
  void append(Frame& frame, std::uint8_t byte);
  Verdict conclude(FrameQueue& queue);
  [[nodiscard]] Verdict why_lost() const;

  WrittenByMainLoop<std::uint32_t> own_address_;
  LineTiming timing_{};
  State state_ = State::Idle;
  std::uint32_t received_ = 0;  ///< bytes of the open frame, also those there is no room for
  bool first_spoiled_ = false;  ///< the first byte had a line error, or a strict gap behind it
  bool rest_spoiled_ = false;   ///< any other byte had
  bool overrun_ = false;        ///< and one of these errors was an overrun
  Crc16 whole_;                 ///< over all bytes
  Crc16 behind_first_;          ///< over all but the first, if that is 00
  Time last_;                   ///< when the last byte was complete
};

}  // namespace ex9000
