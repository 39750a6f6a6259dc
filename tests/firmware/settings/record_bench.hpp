// Records of settings, as a module stores them: contents for tests, and an independent implementation of the
// check.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/settings/record.hpp"

namespace ex9000 {

inline const Model& model(std::string_view designation) { return *find_model(designation); }

/// The contents of a record.
struct Stored {
  Settings settings;
  std::uint16_t sequence;
};

/// Returns contents for a record of an EX9042D-M. Every setting from the address to the safe value, except
/// the protocol, differs from its factory value.
inline Stored changed_settings() {
  Settings settings;
  settings.address = 0xF7;
  settings.baud_code = 0x0A;
  settings.format = 0xC0;
  settings.protocol = Protocol::ModbusRtu;
  settings.name = Name("pump~1");
  settings.power_on_value = 0x1A5C;
  settings.safe_value = 0x03FF;
  settings.watchdog_enabled = true;
  settings.watchdog_timeout = 0x64;
  settings.timeout_status = true;
  settings.updates_allowed = true;  // the factory value, so the record does not contain it
  return {settings, 0xBEEF};
}

inline const Model& the_model() { return model("EX9042D-M"); }

inline Stored factory() { return {Settings::factory(the_model()), 1}; }

using Record = std::vector<std::uint8_t>;

inline Record record_of(const Stored& stored, const Model& which = the_model()) {
  RecordBytes bytes{};
  write_record(which, stored.settings, stored.sequence, bytes);
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(record_size({bytes.data(), 4}))};
}

inline std::optional<StoredSettings> read(const Model& which, const Record& record) {
  return read_record(which, {record.data(), record.size()});
}
inline bool is_good(const Model& which, const Record& record) { return read(which, record).has_value(); }

// The layout of a record that ends after the safe value: firmware/settings/record.hpp.
inline constexpr std::size_t kLengthAt = 1;
inline constexpr std::size_t kSettingsAt = 4;
inline constexpr std::size_t kSettingsSize = 19;
inline constexpr std::size_t kCheckAt = kSettingsAt + kSettingsSize;
inline constexpr std::size_t kRecordSize = kCheckAt + 4;

inline Record filled_with(std::uint8_t byte) { return Record(kRecordSize, byte); }

inline constexpr std::size_t kRecordBits = kRecordSize * 8;

inline Record with_flipped(Record record, std::size_t bit) {
  record[bit / 8] = static_cast<std::uint8_t>(record[bit / 8] ^ (1U << (bit % 8)));
  return record;
}

// --- the check: CRC-32 of IEEE 802.3, bit by bit ---

inline constexpr std::uint32_t kReflectedPolynomial = 0xEDB8'8320U;

inline std::uint32_t taken_in(std::uint32_t crc, std::uint32_t data, int bits) {
  for (; bits > 0; --bits, data >>= 1U) {
    const bool divides = ((crc ^ data) & 1U) != 0;
    crc = divides ? (crc >> 1U) ^ kReflectedPolynomial : crc >> 1U;
  }
  return crc;
}

inline std::uint32_t seed(const Model& which) {
  std::uint32_t crc = 0xFFFF'FFFFU;
  for (const char character : which.designation) {
    crc = taken_in(crc, static_cast<unsigned char>(character), 8);
  }
  return crc;
}

/// Returns the record with a correct check, so that a test can use contents that no module stores.
inline Record with_check(const Model& which, Record record) {
  const std::size_t check_at = record.size() - 4;
  std::uint32_t crc = seed(which);
  for (std::size_t i = 0; i < check_at; ++i) {
    crc = taken_in(crc, record[i], 8);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    record[check_at + i] = static_cast<std::uint8_t>(~crc >> (8 * i));
  }
  return record;
}

/// Returns a random sequence number and random settings that are possible for the model `which`. The settings
/// after the safe value have their factory values.
inline Stored random_settings(const Model& which, std::mt19937& random) {
  const auto below = [&random](std::uint32_t limit) { return static_cast<std::uint32_t>(random() % limit); };
  Settings settings;
  settings.address = static_cast<std::uint8_t>(1 + below(247));
  settings.baud_code = static_cast<std::uint8_t>(3 + below(8));
  settings.format = static_cast<std::uint8_t>(below(4) << 6U);
  settings.protocol = which.speaks_modbus() && below(2) != 0 ? Protocol::ModbusRtu : Protocol::Ascii;
  settings.watchdog_timeout = static_cast<std::uint8_t>(1 + below(255));
  settings.watchdog_enabled = below(2) != 0;
  settings.timeout_status = below(2) != 0;
  std::string name;
  for (std::uint32_t size = 1 + below(which.longest_name); size > 0; --size) {
    name += static_cast<char>(0x20 + below(0x5F));
  }
  settings.name = Name(name);
  settings.power_on_value = static_cast<std::uint16_t>(random() & which.output_mask());
  settings.safe_value = static_cast<std::uint16_t>(random() & which.output_mask());
  settings.updates_allowed = true;
  return {settings, static_cast<std::uint16_t>(random())};
}

}  // namespace ex9000
