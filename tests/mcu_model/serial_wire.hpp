// Characters as levels on a wire: a start bit, 8 data bits with the least significant bit first, a parity bit
// in some formats, and one or two stop bits. The idle line is high.
#pragma once

#include <cstdint>
#include <functional>
#include <utility>

#include "firmware/model/line_format.hpp"
#include "tests/mcu_model/timeline.hpp"

namespace ex9000::registers {

/// The parity bit and the stop bits of a format. The model takes only the names of the formats from the
/// firmware, so that an error in the firmware's functions for formats does not affect the model.
struct Form {
  bool parity_bit;
  bool odd;
  unsigned stop_bits;
};
constexpr Form form_of(LineFormat format) {
  return {format == LineFormat::k8E1 || format == LineFormat::k8O1, format == LineFormat::k8O1,
          format == LineFormat::k8N2 ? 2U : 1U};
}

/// Returns the position of the first stop bit in a character; the start bit is at 0.
constexpr unsigned first_stop_bit(LineFormat format) { return form_of(format).parity_bit ? 10 : 9; }

/// Returns the duration of a character in bits, with all its stop bits.
constexpr unsigned bits_on_wire(LineFormat format) {
  return first_stop_bit(format) + form_of(format).stop_bits;
}

/// Returns the correct level of the parity bit. `format` must have a parity bit.
constexpr bool parity_of(std::uint8_t byte, LineFormat format) {
  bool level = form_of(format).odd;
  for (unsigned bit = 0; bit < 8; ++bit) {
    level = level != ((byte >> bit & 1U) != 0);
  }
  return level;
}

/// One character to send, and its faults.
struct Character {
  std::uint8_t byte = 0;
  bool stop = true;           ///< false: the last bit is low
  unsigned low_bits = 0;      ///< if not 0: a break of this many low bits, then `stop`; no character
  bool wrong_parity = false;  ///< no effect in a format without a parity bit
};

/// Puts characters on a wire, one at a time.
class SerialSender {
 public:
  /// Calls `level` with each bit when the bit begins, and `done` when the last bit ends.
  SerialSender(Timeline& timeline, std::function<void(bool)> level, std::function<void()> done)
      : level_(std::move(level)), done_(std::move(done)), next_bit_(timeline, [this] { go_on(); }) {}

  void begin(Character character, LineFormat format, Instant bit_time, Instant start) {
    character_ = character;
    format_ = format;
    bit_time_ = bit_time;
    start_ = start;
    bit_ = 0;
    next_bit_.set(start);
  }
  [[nodiscard]] bool busy() const { return next_bit_.is_set(); }
  [[nodiscard]] Instant started() const { return start_; }

 private:
  void go_on() {
    const unsigned bits = character_.low_bits != 0 ? character_.low_bits + 1 : bits_on_wire(format_);
    if (bit_ == bits) {
      done_();
      return;
    }
    const bool level =
        bit_ + 1 == bits ? character_.stop : character_.low_bits == 0 && level_before_the_end();
    ++bit_;
    next_bit_.set(start_ + bit_ * bit_time_);
    level_(level);
  }

  [[nodiscard]] bool level_before_the_end() const {
    constexpr unsigned kDataBits = 8;
    if (bit_ == 0) {
      return false;
    }
    if (bit_ <= kDataBits) {
      return (character_.byte >> (bit_ - 1) & 1U) != 0;
    }
    return bit_ == first_stop_bit(format_) || parity_of(character_.byte, format_) != character_.wrong_parity;
  }

  std::function<void(bool)> level_;
  std::function<void()> done_;
  Alarm next_bit_;
  Character character_;
  LineFormat format_ = LineFormat::k8N1;
  Instant bit_time_{0};
  Instant start_{0};
  unsigned bit_ = 0;
};

/// Receives characters from a wire: after a falling edge it samples the middle of each bit, up to the first
/// stop bit.
class SerialReceiver {
 public:
  struct Received {
    std::uint8_t byte;
    bool parity_error;
    bool framing_error;  ///< the first stop bit was low
    bool was_break;      ///< all bits were low
  };

  /// Calls `deliver` in the middle of the first stop bit.
  SerialReceiver(Timeline& timeline, std::function<void(Received)> deliver)
      : deliver_(std::move(deliver)), next_look_(timeline, [this] { look(); }), timeline_(timeline) {}

  void set_bit_time(Instant time) { bit_time_ = time; }
  /// A character that is being received continues in the new format.
  void set_format(LineFormat format) { format_ = format; }
  [[nodiscard]] bool busy() const { return next_look_.is_set(); }

  /// Must be called when the level of the wire has changed.
  void level(bool high) {
    const bool fell = level_ && !high;
    level_ = high;
    if (fell && !busy() && bit_time_.count() != 0) {
      bit_ = 0;
      levels_ = 0;
      start_ = timeline_.now();
      next_look_.set(start_ + bit_time_ / 2);
    }
  }

 private:
  void look() {
    if (bit_ == 0 && level_) {
      return;  // a spike, not a start bit
    }
    levels_ |= (level_ ? 1U : 0U) << bit_;
    if (bit_ >= first_stop_bit(format_)) {
      deliver_(received());
      return;
    }
    ++bit_;
    next_look_.set(start_ + bit_ * bit_time_ + bit_time_ / 2);
  }

  [[nodiscard]] Received received() const {
    constexpr unsigned kParityBit = 9;
    const auto byte = static_cast<std::uint8_t>(levels_ >> 1U);
    const bool parity = (levels_ >> kParityBit & 1U) != 0;
    return {byte, form_of(format_).parity_bit && parity != parity_of(byte, format_), !level_, levels_ == 0};
  }

  std::function<void(Received)> deliver_;
  Alarm next_look_;
  Timeline& timeline_;
  LineFormat format_ = LineFormat::k8N1;
  Instant bit_time_{0};
  Instant start_{0};
  bool level_ = true;
  unsigned bit_ = 0;
  unsigned levels_ = 0;  ///< the bits that have been sampled so far, from the start bit on
};

}  // namespace ex9000::registers
