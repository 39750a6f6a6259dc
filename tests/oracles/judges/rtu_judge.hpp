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
  /// `strict`: a gap of more than 1.5 characters invalidates a frame. `doubt`: the greatest difference
  /// between the clocks of the module and of the judge. If a gap differs by at most this much from the
  /// silence that ends a frame, the module may or may not end the frame. The judge then considers both cases.
  RtuJudge(std::uint8_t own_address, const LineTimes& times, bool strict, Microseconds doubt = 0)
      : own_(own_address),
        received_(times.received),
        silence_(times.silence),
        apart_(strict ? times.slack : kNever),
        doubt_(doubt) {}

  /// Moves the report of a byte to a later time if the gap before it is so near a limit that rounding to
  /// whole microseconds, by the clock or by the module, could change the result. Returns the new time.
  [[nodiscard]] Microseconds beyond_doubt(Microseconds end) const {
    if (size_ == 0) {
      return end;
    }
    constexpr Microseconds kDoubt = 6;
    for (const Microseconds border : {silence_, silence_ + received_, apart_}) {
      const Microseconds gap = end - last_;
      if (border != kNever && gap + kDoubt > border && gap < border + kDoubt) {
        end = last_ + border + kDoubt;
      }
    }
    return end;
  }

  /// Call this when no byte has arrived until `now`.
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

  /// Call this when a byte is reported, after `pass` for the time before it.
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

  /// Call this after a reply of the module. Judges a frame that was complete except for the silence after it,
  /// and drops any other.
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
      // The bytes may be a turn-around 00 and a frame.
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
    const auto kind = frame[0] != own_ && frame[0] != 0 ? Finding::Kind::Foreign
                      : host_ok                         ? Finding::Kind::HostOk
                      : frame[0] == 0                   ? Finding::Kind::Broadcast
                                                        : Finding::Kind::Request;
    return {kind, frame, first_, last_};
  }

  std::uint8_t own_;
  Microseconds received_;  ///< a byte that began before the end of the silence is reported within this time
  Microseconds silence_;
  /// The greatest time between the reports of two bytes of a frame; kNever if gaps are not strict.
  Microseconds apart_;
  Microseconds doubt_;
  /// Two more than the longest frame, so that a longer one is noticed.
  static constexpr std::size_t kMost = kLongest + 2;
  std::array<std::uint8_t, kMost> bytes_{};
  std::array<bool, kMost> bad_{};
  std::array<bool, kMost> apart_before_{};
  std::size_t size_ = 0;
  std::size_t judged_ = 0;   ///< the size at the last `judge`
  std::size_t another_ = 0;  ///< offset at which a second frame may have begun; 0: none
  Microseconds first_ = 0;
  Microseconds last_ = 0;
};

}  // namespace ex9000::judges
