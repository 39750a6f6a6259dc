// The places in the memory for copies of the settings.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/settings/record.hpp"

namespace ex9000 {

/// The size in bytes of the smallest page of any supported memory. No write crosses the end of a page, so a
/// power failure damages at most one page.
constexpr std::size_t kMemoryPage = 32;

/// The addresses of the two places for a copy. Each begins at the start of a page of kMemoryPage bytes. A
/// save writes to the place that does not hold the current copy.
constexpr std::array<std::uint16_t, 2> kPlaces{0x0000, 0x0080};
static_assert(kPlaces[0] + kRecordRoom <= kPlaces[1], "a copy does not fit in its place");

/// Whether all `bytes` are FF, as in a memory that was never written.
constexpr bool is_blank(Bytes bytes) {
  for (const std::uint8_t byte : bytes) {
    if (byte != 0xFF) {
      return false;
    }
  }
  return true;
}

}  // namespace ex9000
