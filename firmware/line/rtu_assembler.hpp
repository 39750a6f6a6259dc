// Assembles Modbus RTU frames from received bytes and silences; runs in the receive and timer interrupts.
#pragma once

#include <cstdint>

#include "firmware/line/crc16.hpp"
#include "firmware/line/crossing.hpp"
#include "firmware/line/frame_queue.hpp"
#include "firmware/line/timing.hpp"
#include "firmware/line/verdict.hpp"
#include "firmware/model/built.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// address, function, data, CRC, then T3.5 of silence - wire.md section 7. The CRC is taken along byte by
/// byte: a frame for this module is announced as soon as it comes out right, and at the silence the verdict
/// is there at once.
class RtuAssembler {
 public:
  void use(const LineTiming& timing) { timing_ = timing; }
  [[nodiscard]] const LineTiming& timing() const { return timing_; }
  /// Main loop, also while bytes come in: the module's address, from the next frame on that ends.
  void answer_to(std::uint8_t address) { own_address_.store_in_main_loop(address); }

  /// Receive interrupt; `now` is when the byte was complete. Tells what became of the frame before it where
  /// it came so late that it opens the next one. Restart the silence timer with `silence()` after it.
  Verdict byte(FrameQueue& queue, std::uint8_t byte, ByteStatus status, Time now);

  /// Timer interrupt: no byte was complete since T3.5. Where the CRC is not right yet, a byte may be under
  /// way that started in time: then `wants_more_silence()`, and the second call without a byte between ends
  /// the frame. An accepted frame holds address, function and data, without CRC and without a turn-around 00
  /// before it.
  Verdict silence(FrameQueue& queue) {
    const Verdict verdict = conclude(queue);
    return verdict != Verdict::Open ? verdict : lapse();
  }
  /// The two parts of it: where the CRC is right, and where the first has found nothing.
  Verdict conclude(FrameQueue& queue);
  Verdict lapse();
  /// When the silence was over that `silence` tells of, at the earliest.
  [[nodiscard]] Time silent_since() const { return last_ + timing_.rtu_silence; }

  [[nodiscard]] bool wants_more_silence() const { return lapsed_ != 0 && lapsed_ == received_; }

  /// Interrupt. The own driver was on: a frame whose CRC is right was whole and is judged, any other is
  /// forgotten.
  Verdict cut_off(FrameQueue& queue);

 private:
  void close() {
    received_ = 0;
    lapsed_ = 0;
  }
  [[nodiscard]] bool strict() const { return kBuiltStrictGaps && timing_.rtu_slack < timing_.rtu_silence; }
  void spoil(ByteStatus status);
  Verdict behind_a_gap(FrameQueue& queue, Duration since_last);
  Verdict late(FrameQueue& queue, Duration since_last);
  /// Ends the open frame, which is nothing; why is known.
  Verdict lose() {
    close();
    return loss_;
  }
  [[nodiscard]] Verdict why_lost() const;

  static constexpr std::uint8_t kFirst =
      1;  ///< the first byte came with an error, or stood apart from the rest
  static constexpr std::uint8_t kRest = 2;     ///< any other did
  static constexpr std::uint8_t kOverrun = 4;  ///< and it was an overrun

  WrittenByMainLoop<std::uint32_t> own_address_;
  LineTiming timing_{};
  Duration gap_;                  ///< between two bytes of the open frame, from which on it means something
  std::uint8_t spoiled_ = 0;      ///< what kinds of bytes have: kFirst and so on
  std::uint8_t first_ = 0;        ///< the first byte
  Verdict loss_ = Verdict::Open;  ///< what the frame is if nothing comes any more, from when T3.5 had passed
  std::uint32_t received_ = 0;  ///< bytes of the open frame, also those there is no room for; 0: none is open
  std::uint32_t lapsed_ = 0;    ///< how many they were when T3.5 had passed once; 0: it has not
  std::uint32_t announced_ = 0;         ///< likewise when it was announced
  Time last_;                           ///< when the last byte was complete
  Crc16 whole_ = Crc16::none();         ///< over all bytes
  Crc16 behind_first_ = Crc16::none();  ///< over all but the first, where that is 00
};

}  // namespace ex9000
