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

/// A good copy. Of several, the later sequence number wins.
struct StoredSettings {
  Settings settings;
  std::uint16_t sequence = 0;
};

/// Sequence numbers wrap: 1 to 32767 ahead, modulo 65536, is later.
constexpr bool is_later(std::uint16_t sequence, std::uint16_t than) {
  constexpr std::uint16_t kHalfRange = 0x8000;
  const auto ahead = static_cast<std::uint16_t>(sequence - than);
  return ahead != 0 && ahead < kHalfRange;
}

/// The largest copy of the settings in bytes: four pages of an AT24C64.
constexpr std::size_t kRecordRoom = 128;

/// One copy of the settings:
///
///     0           layout, 1
///     1           length n of the settings in bytes, 0 to 120
///     2-3         sequence, low byte first
///     4 to 3 + n  the settings in the order of `visit`, without gaps: numbers low byte first, flags
///                 and the protocol as 0 or 1, the name as seven characters, padded with 0, and its length
///     then        CRC-32 over the designation and all bytes before it, low byte first
///
/// New settings are only appended. A new record ends after the last setting that differs from its factory
/// value, but not before the end of `safe_value`. Settings that a record lacks, also one of older firmware,
/// have their factory values. `write_record` keeps the additional bytes of newer firmware.
///
/// The CRC includes the designation, so that settings of another model are never used: their power-on value
/// is for other outputs. If the length is right, it detects every error burst up to 32 bits and every error
/// of two or three bits; it misses others, say only some new pages, with a probability of about 2^-32.
constexpr std::uint8_t kLayout = 1;
constexpr std::size_t kHeaderSize = 4;  ///< layout, length and sequence
using RecordBytes = std::array<std::uint8_t, kRecordRoom>;

/// `record` must be a good record or all zeros. Keeps what newer firmware has appended to it.
void write_record(const Model& model, const Settings& settings, std::uint16_t sequence, RecordBytes& record);

/// Of the record that begins with `beginning`, at least kHeaderSize bytes. Size 0: that begins no record.
std::size_t record_size(Bytes beginning);
std::uint16_t sequence_of(Bytes beginning);

/// Nothing unless `record`, at least kHeaderSize bytes, begins with a complete and good record: layout,
/// length and check are correct, and the model could have stored these settings.
std::optional<StoredSettings> read_record(const Model& model, Bytes record);

}  // namespace ex9000
