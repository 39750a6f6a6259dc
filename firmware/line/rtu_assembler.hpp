// Assembles Modbus RTU frames from received bytes and silences; runs in the receive and timer interrupts.
#pragma once

#include <cstdint>

#include "firmware/line/crc16.hpp"
#include "firmware/line/frame_queue.hpp"
#include "firmware/line/timing.hpp"
#include "firmware/line/verdict.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// address, function, data, CRC, then T3.5 of silence - wire.md section 7. The CRC is taken along byte by
/// byte, so that at the silence the judgement is there at once.
class RtuAssembler {
 public:
  void use(const LineTiming& timing) { timing_ = timing; }
  [[nodiscard]] const LineTiming& timing() const { return timing_; }

  /// Receive interrupt; `now` is when the byte was complete. Tells what became of the frame before it where
  /// it came so late that it opens the next one. Restart the silence timer with `silence()` after it.
  Verdict byte(FrameQueue& queue, std::uint8_t byte, ByteStatus status, std::uint8_t own_address, Time now);

  /// Timer interrupt: no byte was complete since T3.5. Where the CRC is not right yet, a byte may be under
  /// way that started in time: then `wants_more_silence()`, and the second call without a byte between ends
  /// the frame. An accepted frame holds address, function and data, without CRC and without a turn-around 00
  /// before it.
  Verdict silence(FrameQueue& queue, std::uint8_t own_address);
  /// When the silence was over that `silence` tells of, at the earliest.
  [[nodiscard]] Time silent_since() const { return last_ + timing_.rtu_silence; }

  [[nodiscard]] bool wants_more_silence() const { return lapsed_; }

  /// Interrupt. The own driver has come on: a frame whose CRC is right was whole and is judged, any other is
  /// forgotten.
  Verdict cut_off(FrameQueue& queue, std::uint8_t own_address);

 private:
  void close() {
    received_ = 0;
    lapsed_ = false;
  }
  void spoil(ByteStatus status);
  Verdict late(FrameQueue& queue, std::uint8_t own_address, Duration since_last);
  Verdict conclude(FrameQueue& queue, std::uint8_t own_address);
  Verdict lose();
  [[nodiscard]] Verdict why_lost() const;

  static constexpr std::uint8_t kFirst =
      1;  ///< the first byte came with an error, or stood apart from the rest
  static constexpr std::uint8_t kRest = 2;     ///< any other did
  static constexpr std::uint8_t kOverrun = 4;  ///< and it was an overrun

  LineTiming timing_{};
  bool lapsed_ = false;         ///< T3.5 has passed once
  std::uint8_t spoiled_ = 0;    ///< what kinds of bytes have: kFirst and so on
  bool turned_around_ = false;  ///< the first byte is 00
  std::uint16_t received_ = 0;  ///< bytes of the open frame, also those there is no room for; 0: none is open
  Time last_;                   ///< when the last byte was complete
  Crc16 whole_ = Crc16::none();         ///< over all bytes
  Crc16 behind_first_ = Crc16::none();  ///< over all but the first, where that is 00
};

}  // namespace ex9000
