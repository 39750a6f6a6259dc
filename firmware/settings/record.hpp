// Settings as they lie in the memory.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"

namespace ex9000 {

/// One copy of the settings. It fits one page of the EEPROM (32 bytes on an AT24C64), so that one page write
/// stores it.
///
///     0      address
///     1      baud code
///     2      format
///     3      protocol
///     4      host watchdog timeout
///     5      host watchdog enabled, 0 or 1
///     6      timeout status, 0 or 1
///     7      0
///     8-14   name, filled up with 0
///     15     length of the name
///     16-17  power-on value, low byte first
///     18-19  safe value
///     20-21  sequence: the copy with the later one counts
///     22-23  layout, 2
///     24-27  CRC-32 (IEEE 802.3) over the model's designation and bytes 0 to 23, low byte first
///
/// The CRC begins with the designation, so that what another model has written never counts: its power-on
/// value was meant for other outputs. It sees every difference within one word, and every one of two or three
/// bits wherever they are; others slip through once in 2^32 times. A torn page is one of those; the sixteen
/// bits of a CRC-16 would be too few.
constexpr std::size_t kRecordSize = 28;
constexpr std::size_t kRecordCheckAt = 24;

struct alignas(4) Record {
  std::array<std::uint8_t, kRecordSize> bytes{};

  friend bool operator==(const Record& a, const Record& b);
};

void make_record(const Model& model, const Settings& settings, std::uint16_t sequence, Record& record);
/// The same in two parts: all but the check, and the check.
void fill_record(const Settings& settings, std::uint16_t sequence, Record& record);
void seal_record(const Model& model, Record& record);

/// False where layout or check is wrong, or where the model could not have stored this.
bool is_good(const Model& model, const Record& record);
/// Of a good one.
const Settings& settings_in(const Record& record);
std::uint16_t sequence_in(const Record& record);
/// Sequence numbers wrap; the later one is less than half the range ahead.
constexpr bool is_later(std::uint16_t a, std::uint16_t b) {
  return static_cast<std::uint16_t>(a - b) - 1U < 0x7FFFU;
}

/// Whether the memory was never written here: an erased EEPROM reads all FF.
bool is_blank(const Record& record);

}  // namespace ex9000
