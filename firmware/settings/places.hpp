// The places in the memory for copies of the settings.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "firmware/bytes.hpp"
#include "firmware/settings/old_layouts.hpp"
#include "firmware/settings/record.hpp"

namespace ex9000 {

/// The size in bytes of the smallest page of any supported memory. No write crosses the end of a page, so a
/// power failure damages at most one page.
constexpr std::size_t kMemoryPage = 32;

/// A part of the memory for one copy. It begins at the start of a page of kMemoryPage bytes and shares no
/// such page with another place.
struct Place {
  std::uint16_t address;
  bool old;  ///< a place of layouts 1 and 2; this firmware writes to it only to invalidate the copy
};

/// A save writes to one of the first two places, but never to the place of the current copy. The other two
/// places are those of layouts 1 and 2. The copies there stay valid until the first save in layout 3 is
/// verified, so a power failure during that save does not lose the settings. For an exception, see
/// SettingsStore::update_unfinished.
constexpr std::array<Place, 4> kPlaces{{{0x0080, false}, {0x0100, false}, {0x0000, true}, {0x0020, true}}};
static_assert(kOldCopySize <= kMemoryPage && kRecordRoom <= 0x0080, "a copy does not fit in its place");

/// Returns the size in bytes of the copy at `place` that begins with `first_page`. Returns 0 if the place is
/// not old and the page is not the beginning of a record.
std::size_t copy_size(const Place& place, Bytes first_page);

/// Returns the settings and their edition if `copy`, which contains the bytes at `place`, is a good copy.
/// Otherwise returns nothing.
std::optional<StoredSettings> read_copy(const Model& model, const Place& place, Bytes copy);

/// Returns whether all `bytes` are FF, as in a memory that was never written.
bool is_blank(Bytes bytes);

}  // namespace ex9000
