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

/// Returns the byte at position `index` of the settings of a longer record, from 19 on: the factory values,
/// which are 0 except the last one, 1, and after the settings that this firmware supports, `unknown_byte`.
inline std::uint8_t later_byte(std::size_t index) {
  constexpr std::size_t kLast = StoredCopy::bytes_of_all() - 1;
  return index > kLast ? unknown_byte(index) : std::uint8_t{index == kLast};
}

/// Extends the valid record at `place`, which has at least 19 bytes of settings, to `length` bytes, with
/// `later_byte`.
inline void lengthen(const Model& model, std::uint8_t* memory, std::size_t place, std::uint8_t length) {
  std::uint8_t* bytes = memory + place;
  for (std::size_t index = bytes[1]; index < length; ++index) {
    bytes[4 + index] = later_byte(index);
  }
  bytes[1] = length;
  StoredCopy::seal(model, memory, place);
}

}  // namespace ex9000
