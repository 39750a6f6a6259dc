// A simulated wire with a silence timer, and frames, for tests of the RTU assembler.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/line/rtu_assembler.hpp"
#include "sim/app/play/modbus_frame.hpp"

namespace ex9000 {

using FrameBytes = std::vector<std::uint8_t>;
using Verdicts = std::vector<Verdict>;
using Nanoseconds = std::int64_t;

inline constexpr std::uint8_t kOwn = 0x01;

/// An example frame of wire.md section 7.
inline const FrameBytes kChannel0On{0x01, 0x05, 0x00, 0x00, 0xFF, 0x00, 0x8C, 0x3A};

/// Returns a frame of `size` bytes, including the CRC. `size` must be at least 4.
inline FrameBytes frame_of(std::size_t size, std::uint8_t address = kOwn) {
  FrameBytes bytes{address, 0x10};
  while (bytes.size() < size - 2) {
    bytes.push_back(static_cast<std::uint8_t>(bytes.size() * 11 + 5));
  }
  return with_crc(bytes);
}

inline FrameBytes without_crc(const FrameBytes& frame) { return {frame.begin(), frame.end() - 2}; }

inline FrameBytes behind(std::uint8_t first, const FrameBytes& frame) {
  FrameBytes bytes{first};
  bytes.insert(bytes.end(), frame.begin(), frame.end());
  return bytes;
}

/// Returns T1.5 or T3.5 (Modbus over Serial Line V1.02, 2.5.1.1) in nanoseconds. Up to 19200 baud, the time
/// is `halves` times half a character of 11 bits. Above 19200 baud, the time is `fixed`.
inline Nanoseconds silence_of_half_characters(int halves, std::uint32_t baud, Nanoseconds fixed) {
  return baud <= 19200 ? Nanoseconds{halves} * 11 * 500'000'000 / baud : fixed;
}
inline Nanoseconds t15(std::uint32_t baud) { return silence_of_half_characters(3, baud, 750'000); }
inline Nanoseconds t35(std::uint32_t baud) { return silence_of_half_characters(7, baud, 1'750'000); }

/// The silence timer counts whole microseconds and may be 5 us late each time, so the assembler uses rounded
/// times. A gap that must be shorter or longer than a limit therefore differs from the limit by at least this
/// time.
inline constexpr Nanoseconds kClock = 15'000;

/// A wire at one baud rate, with its silence timer. A byte takes ten bits in 8N1 and eleven in the other
/// formats; the assembler receives it when its first stop bit ends.
class Wire {
 public:
  Wire(RtuAssembler& assembler, FrameQueue& queue, std::uint32_t baud, LineFormat format = LineFormat::k8N1)
      : assembler_(assembler),
        queue_(queue),
        bit_(Nanoseconds{1'000'000'000} / baud),
        bits_(format == LineFormat::k8N1 ? 10 : 11),
        second_stop_bit_(format == LineFormat::k8N2 ? 1 : 0) {
    assembler_.use(LineTiming::at(baud, format));
  }

  [[nodiscard]] Nanoseconds character() const { return bits_ * bit_; }

  void byte(std::uint8_t value, ByteStatus status = ByteStatus::Good) {
    now_ += character() - second_stop_bit_ * bit_;
    run_timer();
    assembler_.answer_to(own);
    const Duration wait = assembler_.byte(queue_, value, status);
    due_ = now_ / 1000 + wait.microseconds() + late_by;
    now_ += second_stop_bit_ * bit_;
  }
  void bytes(const FrameBytes& values) {
    for (const std::uint8_t value : values) {
      byte(value);
    }
  }
  /// Lets time pass between a stop bit and the next start bit.
  void silence(Nanoseconds length) { now_ += length; }
  /// Lets one second pass, which ends every frame.
  void rest() {
    silence(1'000'000'000);
    run_timer();
  }
  void frame(const FrameBytes& values) {
    bytes(values);
    rest();
  }

  [[nodiscard]] Time time() const { return Time(static_cast<std::uint32_t>(now_ / 1000)); }
  void start_at(Time time) { now_ = Nanoseconds{time.microseconds()} * 1000; }

  std::uint8_t own = kOwn;
  Nanoseconds late_by =
      0;                ///< lateness of the silence timer in microseconds, at most 5 (hal/one_shot_timer.hpp)
  bool collect = true;  ///< whether each queued frame is moved to `frames`
  Verdicts verdicts;
  std::vector<FrameBytes> frames;
  Time received;  ///< when the last byte of the latest frame in `frames` was reported

 private:
  void run_timer() {
    while (due_ && *due_ < now_ / 1000) {
      note(assembler_.silence(queue_, Time(static_cast<std::uint32_t>(*due_))));
      const Duration more = assembler_.next_wait();
      if (more == Duration()) {
        due_.reset();
      } else {
        *due_ += more.microseconds() + late_by;
      }
    }
  }
  void note(Verdict verdict) {
    if (verdict == Verdict::Open) {
      return;
    }
    verdicts.push_back(verdict);
    const Frame* frame = queue_.has_frame() ? &queue_.waiting() : nullptr;
    if (collect && frame != nullptr) {
      frames.emplace_back(frame->bytes().begin(), frame->bytes().end());
      received = frame->received;
      queue_.drop_in_main_loop();
    }
  }

  RtuAssembler& assembler_;
  FrameQueue& queue_;
  Nanoseconds bit_;
  Nanoseconds bits_;
  Nanoseconds second_stop_bit_;  ///< 1 if a byte has a second stop bit, otherwise 0
  Nanoseconds now_ = 1'000'000'000;
  /// When the silence timer expires, in microseconds. Empty if the timer does not run.
  std::optional<Nanoseconds> due_;
};

}  // namespace ex9000
