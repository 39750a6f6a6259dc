// Characters as levels on a wire: 8N1, low bit first, idle high.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <utility>

#include "tests/mcu_model/timeline.hpp"

namespace ex9000::registers {

constexpr unsigned kBitsACharacter = 10;

/// One character, and its faults.
struct Character {
  std::uint8_t byte = 0;
  bool stop = true;       ///< false: the stop bit is low
  unsigned low_bits = 0;  ///< not 0: a break, this many bits low instead of a character
};

/// Puts characters on a wire, one at a time.
class SerialSender {
 public:
  /// Calls `level` with each bit when the bit begins, and `done` when the last stop bit ends.
  SerialSender(Timeline& timeline, std::function<void(bool)> level, std::function<void()> done)
      : level_(std::move(level)), done_(std::move(done)), next_bit_(timeline, [this] { go_on(); }) {}

  void begin(Character character, Instant bit_time, Instant start) {
    character_ = character;
    bit_time_ = bit_time;
    start_ = start;
    bit_ = 0;
    next_bit_.set(start);
  }
  [[nodiscard]] bool busy() const { return next_bit_.is_set(); }
  [[nodiscard]] Instant started() const { return start_; }

 private:
  void go_on() {
    const unsigned bits = character_.low_bits != 0 ? character_.low_bits + 1 : kBitsACharacter;
    if (bit_ == bits) {
      done_();
      return;
    }
    const bool level = bit_ + 1 == bits                        ? character_.stop
                       : bit_ == 0 || character_.low_bits != 0 ? false
                                                               : (character_.byte >> (bit_ - 1) & 1U) != 0;
    ++bit_;
    next_bit_.set(start_ + bit_ * bit_time_);
    level_(level);
  }

  std::function<void(bool)> level_;
  std::function<void()> done_;
  Alarm next_bit_;
  Character character_;
  Instant bit_time_{0};
  Instant start_{0};
  unsigned bit_ = 0;
};

/// Receives characters from a wire: after a falling edge it samples the middle of each bit.
class SerialReceiver {
 public:
  struct Received {
    std::uint8_t byte;
    bool framing_error;  ///< the stop bit was low
    bool was_break;      ///< all other bits were low, too
  };

  /// Calls `deliver` in the middle of the stop bit.
  SerialReceiver(Timeline& timeline, std::function<void(Received)> deliver)
      : deliver_(std::move(deliver)), next_look_(timeline, [this] { look(); }), timeline_(timeline) {}

  void set_bit_time(Instant time) { bit_time_ = time; }
  [[nodiscard]] bool busy() const { return next_look_.is_set(); }

  /// Must be called when the level of the wire has changed.
  void level(bool high) {
    const bool fell = level_ && !high;
    level_ = high;
    if (fell && !busy() && bit_time_.count() != 0) {
      bit_ = 0;
      byte_ = 0;
      start_ = timeline_.now();
      next_look_.set(start_ + bit_time_ / 2);
    }
  }

 private:
  void look() {
    if (bit_ == 0) {
      if (level_) {
        return;  // a spike, not a start bit
      }
    } else if (bit_ < kBitsACharacter - 1) {
      byte_ = static_cast<std::uint8_t>(byte_ | (level_ ? 1U : 0U) << (bit_ - 1));
    } else {
      deliver_({byte_, !level_, !level_ && byte_ == 0});
      return;
    }
    ++bit_;
    next_look_.set(start_ + bit_ * bit_time_ + bit_time_ / 2);
  }

  std::function<void(Received)> deliver_;
  Alarm next_look_;
  Timeline& timeline_;
  Instant bit_time_{0};
  Instant start_{0};
  bool level_ = true;
  unsigned bit_ = 0;
  std::uint8_t byte_ = 0;
};

}  // namespace ex9000::registers
