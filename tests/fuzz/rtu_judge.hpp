// Which bytes are a Modbus frame for the module: wire.md 7, D9 and D11, written down once more.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "tests/fuzz/checks.hpp"
#include "tests/fuzz/finding.hpp"

namespace ex9000::fuzz {

class RtuJudge {
 public:
  /// `strict`: a gap of more than 1.5 characters spoils a frame.
  RtuJudge(std::uint8_t own_address, std::uint32_t baud, bool strict)
      : own_(own_address),
        character_(10'000'000ULL / baud),
        silence_(baud <= 19200 ? 38'500'000ULL / baud : 1750),
        apart_(strict ? character_ + (baud <= 19200 ? 16'500'000ULL / baud : 750) : kNever) {}

  [[nodiscard]] Microseconds character() const { return character_; }
  /// T3.5.
  [[nodiscard]] Microseconds silence() const { return silence_; }

  /// The end of the byte that is to be over at `end`, so that no rounding to whole microseconds, the clock's
  /// or the module's, makes it doubtful what the gap before it is.
  [[nodiscard]] Microseconds beyond_doubt(Microseconds end) const {
    if (size_ == 0) {
      return end;
    }
    constexpr Microseconds kDoubt = 6;
    for (const Microseconds border : {silence_, silence_ + character_, apart_}) {
      const Microseconds gap = end - last_;
      if (border != kNever && gap + kDoubt > border && gap < border + kDoubt) {
        end = last_ + border + kDoubt;
      }
    }
    return end;
  }

  /// So much time has passed without a byte.
  Finding pass(Microseconds now) {
    if (size_ == 0 || now - last_ < silence_) {
      return {};
    }
    const Finding finding = judge();
    if (finding.kind != Finding::Kind::Nothing || is_right_for_others_ ||
        now - last_ >= silence_ + character_) {
      size_ = 0;
    }
    return finding;
  }

  /// A byte is over, `pass` was called of the time before it.
  void byte(std::uint8_t byte, bool good, Microseconds now) {
    const bool stands_apart = size_ != 0 && now - last_ > apart_;
    last_ = now;
    if (size_ == 0) {
      first_is_bad_ = rest_is_bad_ = second_is_apart_ = false;
      first_ = now;
    }
    if (!good) {
      (size_ == 0 ? first_is_bad_ : rest_is_bad_) = true;
    }
    if (stands_apart) {
      (size_ == 1 ? second_is_apart_ : rest_is_bad_) = true;
    }
    if (size_ < bytes_.size()) {
      bytes_[size_++] = byte;
    }
  }

  /// The module has spoken. A frame that was whole but for its silence is judged, any other forgotten.
  Finding spoken() {
    const Finding finding = size_ == 0 ? Finding{} : judge();
    size_ = 0;
    return finding;
  }

 private:
  static constexpr std::size_t kShortest = 4;
  static constexpr std::size_t kLongest = 256;

  [[nodiscard]] bool is_right_from(std::size_t start) const {
    const std::size_t size = size_ - start;
    return size >= kShortest && size <= kLongest && crc16(bytes_.data() + start, size) == 0;
  }

  Finding judge() {
    is_right_for_others_ = false;
    std::size_t start = 0;
    if (first_is_bad_ || rest_is_bad_ || second_is_apart_ || crc16(bytes_.data(), size_) != 0) {
      // Behind a turn-around 00?
      start = 1;
      if (bytes_[0] != 0 || rest_is_bad_) {
        return {};
      }
    }
    if (!is_right_from(start)) {
      return {};
    }
    const Bytes frame{bytes_.data() + start, size_ - start - 2};
    if (frame[0] != own_ && frame[0] != 0) {
      is_right_for_others_ = true;
      return {};
    }
    const bool host_ok =
        frame.size == 6 && (frame[1] == 3 || frame[1] == 4) && frame.word(2) == 0x3038 && frame.word(4) <= 1;
    const auto kind = host_ok         ? Finding::Kind::HostOk
                      : frame[0] == 0 ? Finding::Kind::Broadcast
                                      : Finding::Kind::Request;
    return {kind, frame, first_, last_};
  }

  std::uint8_t own_;
  Microseconds character_;
  Microseconds silence_;
  Microseconds apart_;  ///< between the ends of two bytes, from which on they are too far apart
  std::array<std::uint8_t, kLongest + 2> bytes_{};  ///< two more than a frame may have, and then it is none
  std::size_t size_ = 0;
  Microseconds first_ = 0;
  Microseconds last_ = 0;
  bool first_is_bad_ = false;
  bool rest_is_bad_ = false;
  bool second_is_apart_ = false;
  bool is_right_for_others_ = false;
};

}  // namespace ex9000::fuzz
