// One copy of the settings in the EEPROM, read without the firmware's code. This file is an independent
// implementation of the layouts of firmware/settings/record.hpp and old_layouts.hpp, of the check, and of the
// rules for the settings that commands can store (wire.md sections 4, 7, 8 and 12).
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>

namespace ex9000 {

/// The properties of a model on which the check, the factory values and the possible settings depend.
struct StoringModel {
  std::string_view designation;
  unsigned outputs;
  bool speaks_modbus;
  unsigned longest_name;
  std::string_view factory_name;
  unsigned inputs;
};

/// The settings in a copy.
struct CopiedSettings {
  std::uint8_t address;
  std::uint8_t baud_code;
  std::uint8_t format;
  bool modbus;
  std::uint8_t watchdog_timeout;
  bool watchdog_enabled;
  bool timeout_status;
  std::string name;
  std::uint16_t power_on_value;
  std::uint16_t safe_value;
  std::array<std::uint16_t, 16> filters{};  ///< in ms
  std::uint16_t inverted = 0;
  bool fed_by_requests = false;
  std::uint8_t response_delay = 0;
};

/// The addresses at which copies begin. The first two are for layout 3. The last two are for the older
/// layouts.
constexpr std::array<std::size_t, 4> kStoredPlaces{0x080, 0x100, 0x000, 0x020};
constexpr std::size_t kStoredMemory = 0x180;  ///< bytes of the memory that settings may occupy
constexpr std::size_t kStoredPage = 32;

/// A copy in a memory. Refers to the memory and to the model, which must outlive this object.
class StoredCopy {
 public:
  /// `place`: one of kStoredPlaces.
  StoredCopy(const StoringModel& model, const std::uint8_t* memory, std::size_t place)
      : model_(model), bytes_(memory + place), layout_(place >= 0x080 ? 3 : layout_of_old(bytes_)) {}

  /// Sets the layout number and the check of the copy at `place`. The layout number becomes 2 at a place for
  /// the older layouts, otherwise 3. In layout 3, a length of more than 120 becomes 120.
  static void seal(const StoringModel& model, std::uint8_t* memory, std::size_t place) {
    std::uint8_t* bytes = memory + place;
    if (place >= 0x080) {
      bytes[0] = 3;
      bytes[1] = std::min<std::uint8_t>(bytes[1], kLongest);
    } else {
      bytes[22] = 2;
      bytes[23] = 0;
    }
    const StoredCopy copy(model, memory, place);
    const std::uint32_t check = copy.check();
    for (unsigned i = 0; i < 4; ++i) {
      bytes[copy.check_at() + i] = static_cast<std::uint8_t>(check >> 8 * i);
    }
  }

  [[nodiscard]] bool is_blank() const {
    return std::all_of(bytes_, bytes_ + kStoredPage, [](std::uint8_t byte) { return byte == 0xFF; });
  }
  [[nodiscard]] bool is_good() const {
    if (layout_ == 0 || (layout_ == 3 && (bytes_[0] != 3 || bytes_[1] > kLongest))) {
      return false;
    }
    const std::uint32_t right = check();
    return word(check_at()) == right % 65536 && word(check_at() + 2) == right / 65536 && is_possible();
  }
  /// Returns whether this copy is newer than `other`. Both must be good.
  [[nodiscard]] bool is_newer_than(const StoredCopy& other) const {
    const unsigned ahead = (sequence() - other.sequence()) & 0xFFFFU;
    return layout_ == other.layout_ ? ahead != 0 && ahead < 0x8000 : layout_ > other.layout_;
  }
  /// Returns the settings of a good copy.
  [[nodiscard]] CopiedSettings settings() const {
    const Fields at = fields();
    const bool flags_are_bits = layout_ == 1;
    CopiedSettings settings{byte(at.address, 0x01),
                            byte(at.baud_code, 0x06),
                            byte(at.format, 0x00),
                            byte(at.protocol, model_.speaks_modbus ? 1 : 0) != 0,
                            byte(at.timeout, 0xFF),
                            flags_are_bits ? bytes_[7] % 2 != 0 : byte(at.enabled, 0) != 0,
                            flags_are_bits ? bytes_[7] / 2 % 2 != 0 : byte(at.status, 0) != 0,
                            std::string(model_.factory_name),
                            0,
                            0};
    if (reaches(at.name, 8)) {
      settings.name.assign(reinterpret_cast<const char*>(bytes_ + at.name), bytes_[at.name_length]);
    }
    settings.power_on_value = static_cast<std::uint16_t>(reaches(at.power_on, 2) ? word(at.power_on) : 0);
    settings.safe_value = static_cast<std::uint16_t>(reaches(at.safe, 2) ? word(at.safe) : 0);
    if (layout_ == 3) {
      read_extensions(settings);
    }
    return settings;
  }
  /// Returns the size of a good copy in bytes.
  [[nodiscard]] std::size_t size() const { return check_at() + 4; }

 private:
  static constexpr std::uint8_t kLongest = 120;  // bytes of settings
  // Offsets in a copy of layout 3.
  static constexpr std::size_t kFilters = 23;  // two bytes for each of sixteen inputs
  static constexpr std::size_t kInverted = kFilters + 32;
  static constexpr std::size_t kFedByRequests = kInverted + 2;
  static constexpr std::size_t kResponseDelay = kFedByRequests + 1;

  void read_extensions(CopiedSettings& settings) const {
    for (std::size_t channel = 0; channel < settings.filters.size() && reaches(kFilters, 32); ++channel) {
      settings.filters[channel] = static_cast<std::uint16_t>(word(kFilters + 2 * channel));
    }
    settings.inverted = static_cast<std::uint16_t>(reaches(kInverted, 2) ? word(kInverted) : 0);
    settings.fed_by_requests = byte(kFedByRequests, 0) != 0;
    settings.response_delay = byte(kResponseDelay, 0);
  }

  /// The offsets of the sequence number and of the settings that all layouts have.
  struct Fields {
    std::size_t sequence, address, baud_code, format, protocol, timeout, enabled, status, name, name_length,
        power_on, safe;
  };
  [[nodiscard]] Fields fields() const {
    switch (layout_) {
      case 1:
        return {1, 3, 4, 5, 6, 8, 7, 7, 14, 13, 9, 11};
      case 2:
        return {20, 0, 1, 2, 3, 4, 5, 6, 8, 15, 16, 18};
      default:
        return {2, 4, 5, 6, 7, 8, 9, 10, 11, 18, 19, 21};
    }
  }

  static unsigned layout_of_old(const std::uint8_t* bytes) {
    if (bytes[22] == 2 && bytes[23] == 0) {
      return 2;
    }
    return bytes[0] == 1 ? 1 : 0;
  }

  [[nodiscard]] std::size_t check_at() const {
    return layout_ == 3 ? std::size_t{4} + bytes_[1] : layout_ == 2 ? 24 : 21;
  }
  /// Returns whether the copy contains a setting: `size` bytes from offset `at` on. A copy of layout 3 does
  /// not always contain all settings.
  [[nodiscard]] bool reaches(std::size_t at, std::size_t size) const {
    return layout_ != 3 || at + size <= check_at();
  }
  [[nodiscard]] std::uint8_t byte(std::size_t at, std::uint8_t otherwise) const {
    return reaches(at, 1) ? bytes_[at] : otherwise;
  }
  [[nodiscard]] unsigned sequence() const { return word(fields().sequence); }
  [[nodiscard]] unsigned word(std::size_t at) const { return bytes_[at] + bytes_[at + 1] * 256U; }

  /// Returns the CRC-32 of IEEE 802.3 over the designation and all bytes before the check.
  [[nodiscard]] std::uint32_t check() const {
    std::uint32_t crc = 0xFFFFFFFF;
    const auto add = [&crc](unsigned byte) {
      crc ^= byte;
      crc = crc / 16 ^ kOfDigit[crc % 16];
      crc = crc / 16 ^ kOfDigit[crc % 16];
    };
    for (const char character : model_.designation) {
      add(static_cast<unsigned char>(character));
    }
    std::for_each(bytes_, bytes_ + check_at(), add);
    return ~crc;
  }
  /// For each value of four bits, the result of four shifts of the CRC.
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

  [[nodiscard]] bool is_possible() const {
    const Fields at = fields();
    if (byte(at.protocol, 0) > 1 || (layout_ != 1 && (byte(at.enabled, 0) | byte(at.status, 0)) > 1)) {
      return false;
    }
    if (reaches(at.name, 8) && bytes_[at.name_length] > 7) {
      return false;
    }
    const CopiedSettings found = settings();
    const auto printable = [](char c) { return c >= 0x20 && c <= 0x7E; };
    const bool name = !found.name.empty() && found.name.size() <= model_.longest_name &&
                      std::all_of(found.name.begin(), found.name.end(), printable);
    const bool protocol =
        !found.modbus || (model_.speaks_modbus && found.address >= 1 && found.address <= 247);
    const bool watchdog = !found.watchdog_enabled || found.watchdog_timeout != 0;
    const unsigned beyond = ~((1U << model_.outputs) - 1U);
    const unsigned beyond_inputs = ~((1U << model_.inputs) - 1U);
    bool extensions = (found.inverted & beyond_inputs) == 0 && found.response_delay <= 30 &&
                      (layout_ != 3 || byte(kFedByRequests, 0) <= 1);
    for (std::size_t channel = 0; channel < found.filters.size(); ++channel) {
      extensions = extensions && found.filters[channel] <= (channel < model_.inputs ? 2000 : 0);
    }
    // Bits 7 and 6 of the baud code are the line format; all four formats exist.
    const unsigned rate = found.baud_code % 0x40U;
    return extensions && name && protocol && watchdog && rate >= 0x03 && rate <= 0x0A &&
           (found.format & 0x3FU) == 0 && ((found.power_on_value | found.safe_value) & beyond) == 0;
  }

  const StoringModel& model_;
  const std::uint8_t* bytes_;
  unsigned layout_;  ///< 0: no known layout
};

/// Returns the place of the newest good copy, which the module uses; kStoredMemory if no copy is good.
inline std::size_t place_that_counts(const StoringModel& model, const std::uint8_t* memory) {
  std::size_t counts = kStoredMemory;
  for (const std::size_t place : kStoredPlaces) {
    const StoredCopy copy(model, memory, place);
    if (copy.is_good() &&
        (counts == kStoredMemory || copy.is_newer_than(StoredCopy(model, memory, counts)))) {
      counts = place;
    }
  }
  return counts;
}

}  // namespace ex9000
