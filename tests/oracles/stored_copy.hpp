// One copy of the settings in the EEPROM, read without the firmware's code. This file is an independent
// implementation of the layout of firmware/settings/record.hpp, of the check, and of the rules for the
// settings that commands can store (wire.md sections 4, 7, 8 and 12). It uses only the types of the firmware.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"

namespace ex9000 {

/// The addresses at which copies begin.
constexpr std::array<std::size_t, 2> kStoredPlaces{0x000, 0x080};
constexpr std::size_t kStoredMemory = 0x100;  ///< bytes of the memory that settings may occupy
constexpr std::size_t kStoredPage = 32;

/// A copy in a memory. Refers to the memory and to the model, which must outlive this object.
class StoredCopy {
 public:
  /// `place`: one of kStoredPlaces.
  StoredCopy(const Model& model, const std::uint8_t* memory, std::size_t place)
      : model_(model), bytes_(memory + place) {}

  /// Sets the layout number and the check of the copy at `place`. A length of more than 120 becomes 120.
  static void seal(const Model& model, std::uint8_t* memory, std::size_t place) {
    std::uint8_t* bytes = memory + place;
    bytes[0] = kLayout;
    bytes[1] = std::min<std::uint8_t>(bytes[1], kLongest);
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
    if (bytes_[0] != kLayout || bytes_[1] > kLongest) {
      return false;
    }
    const std::uint32_t right = check();
    return word(check_at()) == right % 65536 && word(check_at() + 2) == right / 65536 && is_possible();
  }
  /// Returns whether this copy is newer than `other`. Both must be good.
  [[nodiscard]] bool is_newer_than(const StoredCopy& other) const {
    const unsigned ahead = (sequence() - other.sequence()) & 0xFFFFU;
    return ahead != 0 && ahead < 0x8000;
  }
  /// Returns the settings of a good copy.
  [[nodiscard]] Settings settings() const {
    Settings settings;
    settings.address = byte(kAddress, 0x01);
    settings.baud_code = byte(kBaudCode, 0x06);
    settings.format = byte(kFormat, 0x00);
    settings.protocol =
        byte(kProtocol, model_.modbus_code != 0 ? 1 : 0) != 0 ? Protocol::ModbusRtu : Protocol::Ascii;
    settings.watchdog_timeout = byte(kTimeout, 0xFF);
    settings.watchdog_enabled = byte(kEnabled, 0) != 0;
    settings.timeout_status = byte(kStatus, 0) != 0;
    settings.name = Name(model_.factory_name);
    if (reaches(kName, 8)) {
      settings.name = Name(Bytes{bytes_ + kName, std::min<std::size_t>(bytes_[kNameLength], 7)});
    }
    settings.power_on_value = static_cast<std::uint16_t>(reaches(kPowerOn, 2) ? word(kPowerOn) : 0);
    settings.safe_value = static_cast<std::uint16_t>(reaches(kSafe, 2) ? word(kSafe) : 0);
    read_extensions(settings);
    return settings;
  }
  /// Returns the size of a good copy in bytes.
  [[nodiscard]] std::size_t size() const { return check_at() + 4; }
  /// Returns the number of bytes that a copy without unknown settings uses for `settings`. The settings in
  /// the copy end with the last setting that differs from its factory value, but not before the end of the
  /// safe value.
  static std::size_t bytes_of(const Settings& settings) {
    const std::size_t end = !settings.updates_allowed       ? kUpdatesAllowed + 1
                            : settings.serial_number != 0   ? kSerialNumber + 4
                            : settings.response_delay != 0  ? kResponseDelay + 1
                            : settings.fed_by_requests      ? kFedByRequests + 1
                            : settings.inverted_inputs != 0 ? kInverted + 2
                            : settings.input_filters.any()  ? kFilters + 32
                                                            : kSafe + 2;
    return end - kAddress;
  }
  /// Returns the number of bytes of all settings that this firmware supports.
  static constexpr std::size_t bytes_of_all() { return kEnd - kAddress; }

 private:
  static constexpr std::uint8_t kLayout = 1;
  static constexpr std::uint8_t kLongest = 120;  // bytes of settings
  // Offsets in a copy.
  static constexpr std::size_t kSequence = 2;
  static constexpr std::size_t kAddress = 4;
  static constexpr std::size_t kBaudCode = 5;
  static constexpr std::size_t kFormat = 6;
  static constexpr std::size_t kProtocol = 7;
  static constexpr std::size_t kTimeout = 8;
  static constexpr std::size_t kEnabled = 9;
  static constexpr std::size_t kStatus = 10;
  static constexpr std::size_t kName = 11;
  static constexpr std::size_t kNameLength = 18;
  static constexpr std::size_t kPowerOn = 19;
  static constexpr std::size_t kSafe = 21;
  static constexpr std::size_t kFilters = 23;  // two bytes for each of sixteen inputs
  static constexpr std::size_t kInverted = kFilters + 32;
  static constexpr std::size_t kFedByRequests = kInverted + 2;
  static constexpr std::size_t kResponseDelay = kFedByRequests + 1;
  static constexpr std::size_t kSerialNumber = kResponseDelay + 1;
  static constexpr std::size_t kUpdatesAllowed = kSerialNumber + 4;
  static constexpr std::size_t kEnd = kUpdatesAllowed + 1;

  void read_extensions(Settings& settings) const {
    for (unsigned channel = 0; channel < kMaxInputs && reaches(kFilters, 32); ++channel) {
      settings.input_filters.set(channel, static_cast<std::uint16_t>(word(kFilters + 2 * channel)));
    }
    settings.inverted_inputs = static_cast<std::uint16_t>(reaches(kInverted, 2) ? word(kInverted) : 0);
    settings.fed_by_requests = byte(kFedByRequests, 0) != 0;
    settings.response_delay = byte(kResponseDelay, 0);
    settings.serial_number =
        reaches(kSerialNumber, 4) ? word(kSerialNumber) | std::uint32_t{word(kSerialNumber + 2)} << 16U : 0;
    settings.updates_allowed = byte(kUpdatesAllowed, 1) != 0;
  }

  [[nodiscard]] std::size_t check_at() const { return std::size_t{4} + bytes_[1]; }
  /// Returns whether the copy contains a setting: `size` bytes from offset `at` on. A copy does not always
  /// contain all settings.
  [[nodiscard]] bool reaches(std::size_t at, std::size_t size) const { return at + size <= check_at(); }
  [[nodiscard]] std::uint8_t byte(std::size_t at, std::uint8_t otherwise) const {
    return reaches(at, 1) ? bytes_[at] : otherwise;
  }
  [[nodiscard]] unsigned sequence() const { return word(kSequence); }
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
    if ((byte(kProtocol, 0) | byte(kEnabled, 0) | byte(kStatus, 0)) > 1) {
      return false;
    }
    if (reaches(kName, 8) && bytes_[kNameLength] > 7) {
      return false;
    }
    const Settings found = settings();
    const Bytes name = found.name.bytes();
    const bool named =
        name.size != 0 && name.size <= model_.longest_name &&
        std::all_of(name.begin(), name.end(), [](unsigned char c) { return c >= 0x20 && c <= 0x7E; });
    const bool protocol = found.protocol == Protocol::Ascii ||
                          (model_.modbus_code != 0 && found.address >= 1 && found.address <= 247);
    const bool watchdog = !found.watchdog_enabled || found.watchdog_timeout != 0;
    const unsigned beyond = ~((1U << model_.outputs) - 1U);
    const unsigned beyond_inputs = ~((1U << model_.inputs) - 1U);
    bool extensions = (found.inverted_inputs & beyond_inputs) == 0 && found.response_delay <= 30 &&
                      byte(kFedByRequests, 0) <= 1 && byte(kUpdatesAllowed, 1) <= 1 &&
                      (found.serial_number == 0 || found.serial_number >> 16U == 0x0D00);
    for (unsigned channel = 0; channel < kMaxInputs; ++channel) {
      extensions = extensions && found.input_filters.of(channel) <= (channel < model_.inputs ? 2000 : 0);
    }
    // Bits 7 and 6 of the baud code are the line format; all four formats exist.
    const unsigned rate = found.baud_code % 0x40U;
    return extensions && named && protocol && watchdog && rate >= 0x03 && rate <= 0x0A &&
           (found.format & 0x3FU) == 0 && ((found.power_on_value | found.safe_value) & beyond) == 0;
  }

  const Model& model_;
  const std::uint8_t* bytes_;
};

/// Returns the place of the newest good copy, which the module uses; kStoredMemory if no copy is good.
inline std::size_t place_that_counts(const Model& model, const std::uint8_t* memory) {
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
