// The settings with which a module starts, according to StoredCopy. Also writes copies of settings in the
// form that newer firmware writes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "tests/oracles/stored_copy.hpp"

namespace ex9000 {

/// Returns the settings with which a module starts if `memory`, of kStoredMemory bytes, is the content of its
/// EEPROM (wire.md section 2).
inline Settings settings_from(const Model& model, const std::uint8_t* memory) {
  const std::size_t place = place_that_counts(model, memory);
  return place == kStoredMemory ? Settings::factory(model) : StoredCopy(model, memory, place).settings();
}

/// Returns an arbitrary value for the byte at position `index` of a record's settings. The byte belongs to a
/// setting that only newer firmware supports.
inline std::uint8_t unknown_byte(std::size_t index) { return static_cast<std::uint8_t>(0xC1U ^ index); }

/// Extends the valid record at `place` to `length` bytes of settings. The record must have at least 19 bytes
/// of settings, because the factory value of each later setting is 0, except that of the last one, 1. The
/// settings that this firmware supports, but that the record lacks, get their factory values. The bytes after
/// them get the values of `unknown_byte`.
inline void lengthen(const Model& model, std::uint8_t* memory, std::size_t place, std::uint8_t length) {
  std::uint8_t* bytes = memory + place;
  constexpr std::size_t kLast = StoredCopy::bytes_of_all() - 1;
  for (std::size_t index = bytes[1]; index < length; ++index) {
    bytes[4 + index] = index <= kLast ? std::uint8_t{index == kLast} : unknown_byte(index);
  }
  bytes[1] = length;
  StoredCopy::seal(model, memory, place);
}

}  // namespace ex9000
