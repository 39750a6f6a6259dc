// Decides which characters are a DCON command for the module: an independent implementation of wire.md 3.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "tests/oracles/judges/checks.hpp"
#include "tests/oracles/judges/finding.hpp"

namespace ex9000::judges {

class DconJudge {
 public:
  DconJudge(std::uint8_t own_address, bool checksum) : own_(own_address), checksum_(checksum) {}

  [[nodiscard]] bool checksum() const { return checksum_; }
  [[nodiscard]] std::uint8_t own_address() const { return own_; }
  /// Call this when the module begins the valid reply to `%`, except in INIT mode. `address`: the address
  /// that `%` sets.
  void answer_to(std::uint8_t address) { own_ = address; }
  /// Call this while the module executes a `%` that sets `address`, because this address may already be in
  /// force. Call this with std::nullopt when the module replies.
  void may_answer_to(std::optional<std::uint8_t> address) { next_ = address; }

  Finding byte(std::uint8_t byte, bool good, Microseconds now) {
    const bool ends = byte == '\r' && good;
    switch (state_) {
      case State::Hunting:
        if (good && is_one_of(byte, "#$%@~")) {
          state_ = State::InFrame;
          spoiled_ = false;
          text_[0] = byte;
          first_ = now;
          size_ = 1;
        } else if (good && is_one_of(byte, "!>?")) {
          state_ = State::Skipping;
        }
        return {};
      case State::Skipping:
        state_ = ends ? State::Hunting : State::Skipping;
        return {};
      case State::InFrame:
        break;
    }
    if (!ends) {
      spoiled_ = spoiled_ || !good || size_ == text_.size();
      if (!spoiled_) {
        text_[size_++] = byte;
      }
      return {};
    }
    state_ = State::Hunting;
    return spoiled_ ? Finding{} : judge(now);
  }

  /// Call this after a reply of the module.
  void spoken() { state_ = State::Hunting; }

 private:
  enum class State { Hunting, InFrame, Skipping };

  static bool is_one_of(std::uint8_t byte, std::string_view characters) {
    return characters.find(static_cast<char>(byte)) != std::string_view::npos;
  }

  [[nodiscard]] Finding judge(Microseconds now) const {
    constexpr std::size_t kDelimiterAndAddress = 3;
    std::size_t size = size_;
    if (checksum_) {
      if (size < kDelimiterAndAddress + 2) {
        return {};
      }
      size -= 2;
      if (!are_digits_of(text_.data() + size, dcon_sum(text_.data(), size))) {
        return {};
      }
    }
    if (size < kDelimiterAndAddress) {
      return {};
    }
    const Bytes frame{text_.data(), size};
    if (size == kDelimiterAndAddress && frame[1] == '*' && frame[2] == '*') {
      const auto kind = frame[0] == '~'   ? Finding::Kind::HostOk
                        : frame[0] == '#' ? Finding::Kind::Broadcast
                                          : Finding::Kind::Foreign;
      return {kind, frame, first_, now};
    }
    if (are_digits_of(frame.data + 1, own_) || (next_ && are_digits_of(frame.data + 1, *next_))) {
      return {Finding::Kind::Request, frame, first_, now};
    }
    return {Finding::Kind::Foreign, frame, first_, now};
  }

  std::uint8_t own_;
  std::optional<std::uint8_t> next_;
  bool checksum_;
  State state_ = State::Hunting;
  bool spoiled_ = false;
  std::array<std::uint8_t, 32> text_{};
  std::size_t size_ = 0;
  Microseconds first_ = 0;
};

}  // namespace ex9000::judges
