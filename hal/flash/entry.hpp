// One version of a page, as the log in the flash stores it.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/settings/crc32.hpp"

namespace ex9000::hal::flash {

/// The size of a page in bytes. See hal/memory.hpp.
inline constexpr std::size_t kPage = 32;
/// The number of pages in the store. Together they have 256 bytes.
inline constexpr std::size_t kPages = 8;

/// The bytes of an entry:
///
///     0-3    sequence, low byte first: an entry replaces entries of the same page with a lower sequence
///     4      page, 0 to 7
///     5-36   content of the page
///     37-40  CRC-32 over bytes 0 to 36, low byte first
///
/// If the power fails while the flash programs an entry, the entry may be incomplete. Its CRC is then wrong,
/// except with a probability of about 2^-32.
inline constexpr std::size_t kPageAt = 4;
inline constexpr std::size_t kContentAt = 5;
inline constexpr std::size_t kCheckAt = kContentAt + kPage;
inline constexpr std::size_t kEntrySize = kCheckAt + 4;
using EntryBytes = std::array<std::uint8_t, kEntrySize>;

inline void put_32(std::uint8_t* to, std::uint32_t value) {
  constexpr unsigned kBitsAByte = 8;
  for (unsigned i = 0; i < sizeof value; ++i) {
    to[i] = static_cast<std::uint8_t>(value >> (i * kBitsAByte));
  }
}

inline std::uint32_t check_of(const EntryBytes& entry) {
  Crc32 crc;
  for (std::size_t i = 0; i < kCheckAt; ++i) {
    crc.add(entry[i]);
  }
  return crc.value();
}

/// Completes an entry that already has its content: sets sequence, page and CRC.
inline void seal(EntryBytes& entry, std::uint32_t sequence, std::size_t page) {
  put_32(entry.data(), sequence);
  entry[kPageAt] = static_cast<std::uint8_t>(page);
  put_32(&entry[kCheckAt], check_of(entry));
}

/// Returns whether `entry` is complete: its page exists and its CRC is right. Returns false for erased bytes
/// and for the mark of a sector.
inline bool is_good(const EntryBytes& entry) {
  const Bytes bytes{entry.data(), entry.size()};
  return entry[kPageAt] < kPages && bytes.low_byte_first_32(kCheckAt) == check_of(entry);
}

inline std::uint32_t sequence_of(const EntryBytes& entry) {
  return Bytes{entry.data(), entry.size()}.low_byte_first_32(0);
}

}  // namespace ex9000::hal::flash
