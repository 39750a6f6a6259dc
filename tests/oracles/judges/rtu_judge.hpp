// Decides which bytes are a Modbus frame for the module: an independent implementation of wire.md section 7,
// wire.md D9 and wire.md D11.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "tests/oracles/judges/checks.hpp"
#include "tests/oracles/judges/finding.hpp"
#include "tests/oracles/judges/line_times.hpp"

namespace ex9000::judges {

class RtuJudge {
 public:
  /// `strict`: a gap of more than T1.5 spoils a frame. `doubt`: the greatest difference between the clocks of
  /// the module and of the judge. If a gap differs by at most `doubt` from the silence that ends a frame, the
  /// module may or may not end the frame. The judge then considers both cases.
  RtuJudge(std::uint8_t own_address, const LineTimes& times, bool strict, Microseconds doubt = 0)
      : own_(own_address),
        received_(times.received),
        silence_(times.silence),
        apart_(strict ? times.slack : kNever),
        doubt_(doubt) {}

  /// Returns the time at which the test must report the next byte: `end`, or a later time if the gap before
  /// the byte is too near a limit. The clock and the module round times, and the module allows for late
  /// timers (wire.md D11). Near a limit, this could change the result.
  [[nodiscard]] Microseconds beyond_doubt(Microseconds end) const {
    if (size_ == 0) {
      return end;
    }
    constexpr Microseconds kDoubt = 15;
    for (const Microseconds border : {silence_, silence_ + received_, apart_}) {
      const Microseconds gap = end - last_;
      if (border != kNever && gap + kDoubt > border && gap < border + kDoubt) {
        end = last_ + border + kDoubt;
      }
    }
    return end;
  }

  /// Call this when no further byte has arrived until `now`. Returns each frame once.
  Finding pass(Microseconds now) {
    if (size_ == 0 || now - last_ + doubt_ < silence_) {
      return {};
    }
    const Microseconds gap = now - last_;
    Finding finding = judge();
    const bool known = std::exchange(judged_, size_) == size_;
    const Microseconds border = finding.kind != Finding::Kind::Nothing ? silence_ : silence_ + received_;
    if (gap >= border + doubt_) {
      size_ = 0;
    } else if (gap + doubt_ >= border) {
      another_ = size_;
      finding.doubtful = true;
    }
    return known ? Finding{} : finding;
  }

  /// Call this when a byte is reported. Call `pass` with the same time before this function.
  void byte(std::uint8_t byte, bool good, Microseconds now) {
    if (size_ == 0) {
      first_ = now;
      judged_ = another_ = 0;
    }
    if (size_ < bytes_.size()) {
      bad_[size_] = !good;
      apart_before_[size_] = now - last_ > apart_;
      bytes_[size_++] = byte;
    }
    last_ = now;
  }

  /// Call this after a reply of the module. Judges a frame if only the silence after the frame is missing,
  /// and drops all other bytes (wire.md D9).
  Finding spoken() {
    const Finding finding = size_ == 0 || judged_ == size_ ? Finding{} : judge();
    size_ = 0;
    return finding;
  }

 private:
  static constexpr std::size_t kShortest = 4;
  static constexpr std::size_t kLongest = 256;

  [[nodiscard]] bool is_whole_from(std::size_t start) const {
    for (std::size_t i = start; i < size_; ++i) {
      if (bad_[i] || (i != start && apart_before_[i])) {
        return false;
      }
    }
    return crc16(bytes_.data() + start, size_ - start) == 0;
  }

  [[nodiscard]] Finding judge() const {
    Finding finding = judge_from(0);
    if (finding.kind == Finding::Kind::Nothing && another_ != 0 && another_ < size_) {
      finding = judge_from(another_);
    }
    finding.doubtful = another_ != 0;
    return finding;
  }

  [[nodiscard]] Finding judge_from(std::size_t start) const {
    if (!is_whole_from(start)) {
      // The first byte may be the 00 of a line turn-around before a frame.
      if (bytes_[start] != 0 || !is_whole_from(start + 1)) {
        return {};
      }
      ++start;
    }
    const std::size_t size = size_ - start;
    if (size < kShortest || size > kLongest) {
      return {};
    }
    const Bytes frame{bytes_.data() + start, size - 2};
    const bool host_ok =
        frame.size == 6 && (frame[1] == 3 || frame[1] == 4) && frame.word(2) == 0x3038 && frame.word(4) <= 1;
    const bool exception = frame[1] >= 0x80;  // of another server
    const auto kind = exception || (frame[0] != own_ && frame[0] != 0) ? Finding::Kind::Foreign
                      : host_ok                                        ? Finding::Kind::HostOk
                      : frame[0] == 0                                  ? Finding::Kind::Broadcast
                                                                       : Finding::Kind::Request;
    return {kind, frame, first_, last_};
  }

  std::uint8_t own_;
  Microseconds received_;  ///< from the start of a byte to the report of the byte
  Microseconds silence_;
  /// The greatest time between the reports of two successive bytes of a frame; kNever: no limit.
  Microseconds apart_;
  Microseconds doubt_;
  /// Two bytes more than the longest frame: the 00 of a line turn-around, and a byte that makes the frame too
  /// long.
  static constexpr std::size_t kMost = kLongest + 2;
  std::array<std::uint8_t, kMost> bytes_{};
  std::array<bool, kMost> bad_{};
  std::array<bool, kMost> apart_before_{};
  std::size_t size_ = 0;
  std::size_t judged_ = 0;   ///< the number of bytes that `pass` has judged
  std::size_t another_ = 0;  ///< offset at which a second frame may have begun; 0: none
  Microseconds first_ = 0;
  Microseconds last_ = 0;
};

}  // namespace ex9000::judges
