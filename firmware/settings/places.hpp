// Where the memory holds copies of the settings.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/bytes.hpp"
#include "firmware/settings/old_layouts.hpp"
#include "firmware/settings/record.hpp"

namespace ex9000 {

/// The smallest page of any supported memory, in bytes. A power cut spoils at most one page, and no write
/// crosses the end of one.
constexpr std::size_t kMemoryPage = 32;

/// A part of the memory for one copy. It begins at the beginning of a page and shares no page with another.
struct Place {
  std::uint16_t address;
  bool old;  ///< for layouts 1 and 2; never written again, except that a copy there is invalidated
};

/// Two places take turns. The places of older firmware keep their settings until this firmware stores
/// something, and so a power cut in its first store leaves them.
constexpr std::array<Place, 4> kPlaces{{{0x0080, false}, {0x0100, false}, {0x0000, true}, {0x0020, true}}};
static_assert(kOldCopySize <= kMemoryPage && kRecordRoom <= 0x0080, "a copy fits its place");

/// What of a copy is read first tells how long the copy is: its first page. 0: this is no copy.
std::size_t copy_size(const Place& place, Bytes first_page);

/// Nothing unless `copy`, which lies at `place`, is a good one.
std::optional<StoredSettings> read_copy(const Model& model, const Place& place, Bytes copy);

/// Whether nothing was ever written where `bytes` were read: an erased EEPROM reads FF.
bool is_blank(Bytes bytes);

}  // namespace ex9000
