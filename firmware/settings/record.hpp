// The layout of the settings in the memory.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/bytes.hpp"
#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"

namespace ex9000 {

/// The contents of a good copy. The copy with the later sequence number is used.
struct StoredSettings {
  Settings settings;
  std::uint16_t sequence = 0;
};

/// Sequence numbers wrap: one is later than another if it is 1 to 32767 ahead, modulo 65536.
constexpr bool is_later(std::uint16_t sequence, std::uint16_t than) {
  constexpr std::uint16_t kHalfRange = 0x8000;
  const auto ahead = static_cast<std::uint16_t>(sequence - than);
  return ahead != 0 && ahead < kHalfRange;
}

/// The largest size of a copy of the settings, in bytes: four pages of an AT24C64.
constexpr std::size_t kRecordRoom = 128;

/// One copy of the settings:
///
///     0           layout, 1
///     1           length n of the settings in bytes, 0 to 120
///     2-3         sequence, low byte first
///     4 to 3 + n  the settings in the order of `visit`, without gaps: numbers with the low
///                 byte first, flags and the protocol as 0 or 1, the name as seven characters,
///                 padded with 0, and its length
///     then        CRC-32 over the model's designation and all bytes before it, low byte first
///
/// New settings are only appended. A new record ends after the last setting that differs from its factory
/// value, but not before the end of `safe_value`. The settings that a record does not contain have their
/// factory values, also if older firmware wrote the record. A record of newer firmware may be longer;
/// `write_record` keeps the additional bytes.
///
/// The CRC includes the designation, so that settings of another model are never used: their power-on value
/// is intended for other outputs. If the length is right, the CRC detects every error burst of up to 32 bits
/// and every error of two or three bits. The probability that it does not detect another error, for example
/// a record with only some new pages, is about 2^-32.
constexpr std::uint8_t kLayout = 1;
constexpr std::size_t kHeaderSize = 4;  ///< layout, length and sequence
using RecordBytes = std::array<std::uint8_t, kRecordRoom>;

/// Writes a complete record with `settings` and `sequence` into `record`. Before the call, `record` must be a
/// good record or contain only zeros. Settings of newer firmware, which follow the known settings, stay the
/// same.
void write_record(const Model& model, const Settings& settings, std::uint16_t sequence, RecordBytes& record);

/// Return the size in bytes and the sequence number of the record that begins with `beginning`, which must
/// have at least kHeaderSize bytes. The size is 0 if `beginning` is not the beginning of a record.
std::size_t record_size(Bytes beginning);
std::uint16_t sequence_of(Bytes beginning);

/// Returns the settings and their sequence number if `record`, which must have at least kHeaderSize bytes,
/// begins with a complete and good record: layout, length and check are correct, and the model could have
/// stored these settings. Otherwise returns nothing.
std::optional<StoredSettings> read_record(const Model& model, Bytes record);

}  // namespace ex9000
