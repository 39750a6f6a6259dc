// What is right of what a receiver has taken in, judged as wire.md has it and by nothing of the firmware's.
// The module's address is 01.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/reference/dcon_check.hpp"

namespace ex9000::noise {

enum class Finding {
  Nothing,  ///< no frame, or one whose check fails
  Foreign,  ///< a frame for another module
  Silent,   ///< carried out without an answer
  Request,  ///< answered
};

/// wire.md 3, in the order it is written there.
class DconJudge {
 public:
  explicit DconJudge(bool checksum) : checksum_(checksum) {}

  /// What `byte` has ended.
  Finding feed(std::uint8_t byte, bool good) {
    const bool ends = byte == '\r' && good;
    if (skipping_) {
      skipping_ = !ends;
      return Finding::Nothing;
    }
    if (text_.empty()) {
      if (good && std::string("#$%@~").find(static_cast<char>(byte)) != std::string::npos) {
        text_ = static_cast<char>(byte);
        spoiled_ = false;
      } else if (good && (byte == '!' || byte == '>' || byte == '?')) {
        skipping_ = true;
      }
      return Finding::Nothing;
    }
    if (!ends) {
      spoiled_ = spoiled_ || !good;
      text_ += static_cast<char>(byte);
      return Finding::Nothing;
    }
    const Finding finding = judge();
    text_.clear();
    return finding;
  }
  /// D9: the module's own driver came on.
  void forget() {
    text_.clear();
    skipping_ = false;
  }
  /// The latest frame that was found right, without its checksum.
  [[nodiscard]] const std::string& frame() const { return frame_; }

 private:
  Finding judge() {
    std::string text = text_;
    if (spoiled_ || text.size() > 32) {
      return Finding::Nothing;
    }
    if (checksum_) {
      if (text.size() < 5) {
        return Finding::Nothing;
      }
      const std::string sent = text.substr(text.size() - 2);
      text.resize(text.size() - 2);
      if (sent != reference::check_of(text)) {
        return Finding::Nothing;
      }
    }
    if (text.size() < 3) {
      return Finding::Nothing;
    }
    frame_ = text;
    if (text == "#**" || text == "~**") {
      return Finding::Silent;
    }
    return text.substr(1, 2) == "01" ? Finding::Request : Finding::Foreign;
  }

  bool checksum_;
  bool skipping_ = false;
  bool spoiled_ = false;
  std::string text_;
  std::string frame_;
};

/// CRC-16/MODBUS over all of `bytes` from `from` on, the CRC itself included, is 0.
inline bool crc_is_right(const std::vector<std::uint8_t>& bytes, std::size_t from) {
  unsigned crc = 0xFFFF;
  for (std::size_t i = from; i < bytes.size(); ++i) {
    crc ^= bytes[i];
    for (int bit = 0; bit < 8; ++bit) {
      crc = crc % 2 != 0 ? crc / 2 ^ 0xA001U : crc / 2;
    }
  }
  return crc == 0;
}

/// wire.md 7: what `bytes` are from `from` on, their CRC being right.
inline Finding meaning_of_rtu(const std::vector<std::uint8_t>& bytes, std::size_t from) {
  const auto at = [&](std::size_t i) { return bytes[from + i]; };
  if (at(0) > 1) {
    return Finding::Foreign;
  }
  const bool host_ok = bytes.size() - from == 8 && (at(1) == 3 || at(1) == 4) && at(2) == 0x30 &&
                       at(3) == 0x38 && at(4) == 0 && at(5) <= 1;
  return at(0) == 0 || host_ok ? Finding::Silent : Finding::Request;
}

/// wire.md 7: a frame that a silence has ended. A 00 before it may be left out; `from` says where it began.
inline Finding judge_rtu(const std::vector<std::uint8_t>& bytes, const std::vector<bool>& good,
                         std::size_t* from = nullptr) {
  for (const std::size_t begin : {0U, 1U}) {
    const std::size_t size = bytes.size() - begin;
    bool fits = bytes.size() > begin && size >= 4 && size <= 256 && (begin == 0 || bytes[0] == 0x00);
    for (std::size_t i = begin; fits && i < bytes.size(); ++i) {
      fits = good[i];
    }
    if (fits && crc_is_right(bytes, begin)) {
      if (from != nullptr) {
        *from = begin;
      }
      return meaning_of_rtu(bytes, begin);
    }
  }
  return Finding::Nothing;
}

}  // namespace ex9000::noise
