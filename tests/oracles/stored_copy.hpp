// One copy of the settings as it lies in the EEPROM, read without the firmware's code: the layout of
// firmware/settings/record.hpp once more, the check from its definition, and wire.md 4 and 8 for what
// commands can have stored.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

namespace ex9000 {

/// What of a model decides which settings it can have.
struct StoringModel {
  std::string_view designation;
  unsigned outputs;
  bool speaks_modbus;
  unsigned longest_name;
};

/// What a copy says, as the bytes say it.
struct StoredSettings {
  std::uint8_t address;
  std::uint8_t baud_code;
  std::uint8_t format;
  bool modbus;
  std::uint8_t watchdog_timeout;
  bool watchdog_enabled;
  bool timeout_status;
  std::string_view name;  ///< within the copy
  std::uint16_t power_on_value;
  std::uint16_t safe_value;
};

/// Refers to the bytes and to the model.
class StoredCopy {
 public:
  static constexpr std::size_t kDistance = 32;  ///< from the first copy to the second
  static constexpr std::size_t kSize = 28;

  StoredCopy(const StoringModel& model, const std::uint8_t* bytes) : model_(model), bytes_(bytes) {}

  /// Makes layout and check right.
  static void seal(const StoringModel& model, std::uint8_t* bytes) {
    bytes[22] = kLayout;
    bytes[23] = 0;
    const std::uint32_t check = check_of(model, bytes);
    for (unsigned i = 0; i < 4; ++i) {
      bytes[kCheckAt + i] = static_cast<std::uint8_t>(check >> 8 * i);
    }
  }

  [[nodiscard]] bool is_blank() const {
    return std::all_of(bytes_, bytes_ + kSize, [](std::uint8_t byte) { return byte == 0xFF; });
  }
  [[nodiscard]] bool is_good() const {
    const std::uint32_t check = check_of(model_, bytes_);
    return word(24) == check % 65536 && word(26) == check / 65536 && word(22) == kLayout && is_possible();
  }
  /// Of two good ones.
  [[nodiscard]] bool is_later_than(const StoredCopy& other) const {
    const unsigned ahead = (word(20) - other.word(20)) & 0xFFFFU;
    return ahead != 0 && ahead < 0x8000;
  }
  /// Of a good one.
  [[nodiscard]] StoredSettings settings() const {
    return {bytes_[0],
            bytes_[1],
            bytes_[2],
            bytes_[3] != 0,
            bytes_[4],
            bytes_[5] != 0,
            bytes_[6] != 0,
            {reinterpret_cast<const char*>(bytes_ + 8), bytes_[15]},
            static_cast<std::uint16_t>(word(16)),
            static_cast<std::uint16_t>(word(18))};
  }

 private:
  static constexpr std::size_t kCheckAt = 24;
  static constexpr std::uint8_t kLayout = 2;

  /// CRC-32 of IEEE 802.3 over the designation and all that is in front of the check.
  static std::uint32_t check_of(const StoringModel& model, const std::uint8_t* bytes) {
    std::uint32_t crc = 0xFFFFFFFF;
    const auto add = [&crc](unsigned byte) {
      crc ^= byte;
      crc = crc / 16 ^ kOfDigit[crc % 16];
      crc = crc / 16 ^ kOfDigit[crc % 16];
    };
    for (const char character : model.designation) {
      add(static_cast<unsigned char>(character));
    }
    std::for_each(bytes, bytes + kCheckAt, add);
    return ~crc;
  }
  /// Four shifts of each value of four bits.
  static constexpr std::array<std::uint32_t, 16> kOfDigit = [] {
    std::array<std::uint32_t, 16> table{};
    for (std::uint32_t i = 0; i < table.size(); ++i) {
      std::uint32_t crc = i;
      for (unsigned bit = 0; bit < 4; ++bit) {
        crc = crc % 2 != 0 ? crc / 2 ^ 0xEDB88320U : crc / 2;
      }
      table[i] = crc;
    }
    return table;
  }();

  [[nodiscard]] unsigned word(std::size_t at) const { return bytes_[at] + bytes_[at + 1] * 256U; }

  [[nodiscard]] bool is_possible() const {
    const std::uint8_t length = bytes_[15];
    const bool name =
        length >= 1 && length <= model_.longest_name &&
        std::all_of(bytes_ + 8, bytes_ + 8 + length, [](std::uint8_t c) { return c >= 0x20 && c <= 0x7E; });
    const bool protocol =
        bytes_[3] == 0 || (bytes_[3] == 1 && model_.speaks_modbus && bytes_[0] >= 1 && bytes_[0] <= 247);
    const bool watchdog = bytes_[5] == 0 || (bytes_[5] == 1 && bytes_[4] != 0);
    const unsigned beyond = ~((1U << model_.outputs) - 1U);
    return name && protocol && watchdog && bytes_[6] <= 1 && bytes_[1] >= 0x03 && bytes_[1] <= 0x0A &&
           (bytes_[2] & 0x3FU) == 0 && ((word(16) | word(18)) & beyond) == 0;
  }

  const StoringModel& model_;
  const std::uint8_t* bytes_;
};

/// Which of the two copies that begin at `memory` counts; null: neither is good.
inline const std::uint8_t* later_good_copy(const StoringModel& model, const std::uint8_t* memory) {
  const StoredCopy first(model, memory);
  const StoredCopy second(model, memory + StoredCopy::kDistance);
  if (!first.is_good() && !second.is_good()) {
    return nullptr;
  }
  const bool second_counts = !first.is_good() || (second.is_good() && second.is_later_than(first));
  return second_counts ? memory + StoredCopy::kDistance : memory;
}

}  // namespace ex9000
