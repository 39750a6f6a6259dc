// The settings as they lie in the memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/bytes.hpp"
#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"

namespace ex9000 {

/// What says which of several good copies counts.
struct Edition {
  std::uint8_t layout = 0;
  std::uint16_t sequence = 0;

  /// A newer layout always counts over an older one. In one layout the later sequence number counts. The
  /// numbers wrap: the later one is less than half the range ahead.
  [[nodiscard]] constexpr bool counts_over(const Edition& other) const {
    constexpr std::uint16_t kHalfRange = 0x8000;
    const auto ahead = static_cast<std::uint16_t>(sequence - other.sequence);
    return layout == other.layout ? ahead != 0 && ahead < kHalfRange : layout > other.layout;
  }
};

/// What a good copy holds.
struct StoredSettings {
  Settings settings;
  Edition edition;
};

/// The check of stored settings: CRC-32 over the model's designation and `bytes`.
std::uint32_t settings_check(const Model& model, Bytes bytes);

/// The bytes that one copy of the settings may take; four pages of an AT24C64.
constexpr std::size_t kRecordRoom = 128;

/// One copy of the settings, layout 3:
///
///     0           layout, 3
///     1           length n of the settings in bytes, 0 to 120
///     2-3         sequence, low byte first
///     4 to 3 + n  the settings in the order of EX9000_SETTINGS, without gaps: numbers with the low byte
///     first, flags
///                 and the protocol as 0 or 1, the name as seven characters, filled up with 0, and its length
///     then        CRC-32 over the model's designation and all bytes before, low byte first
///
/// Settings are only appended. A record of older firmware is shorter: the settings that it lacks have their
/// factory values. A record of newer firmware is longer: `write_record` keeps the bytes that this firmware
/// does not know.
///
/// The CRC begins with the designation, so that settings of another model never count: their power-on value
/// is meant for other outputs. It detects every difference within 32 bits, and every difference of two or
/// three bits; another one, such as a record of which only some pages are new, passes once in 2^32 times.
constexpr std::uint8_t kLayout = 3;
using RecordBytes = std::array<std::uint8_t, kRecordRoom>;

/// Makes `record` a good one. If it is a good one already, and longer, the bytes behind the known settings
/// stay; otherwise it has to be all zeros.
void write_record(const Model& model, const Settings& settings, std::uint16_t sequence, RecordBytes& record);

/// The size of the record that begins with these four bytes or more; 0 if none begins there.
std::size_t record_size(Bytes beginning);

/// Nothing unless `record` begins with a whole and good record: layout, length and check are right, and the
/// model could have stored these settings.
std::optional<StoredSettings> read_record(const Model& model, Bytes record);

}  // namespace ex9000
