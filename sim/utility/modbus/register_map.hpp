// Where a module has what: the rows of firmware/registers, by their ids.
#pragma once

#include <stdexcept>
#include <string_view>

#include "firmware/registers/bits.hpp"
#include "firmware/registers/words.hpp"

namespace ex9000::utility {

/// For constants only: a wrong id is an error at compile time.
template <class Rows>
constexpr const auto& row_called(const Rows& rows, std::string_view id) {
  for (const auto& each : rows) {
    if (each.id == id) {
      return each.row;
    }
  }
  throw std::invalid_argument("there is no such row");
}

/// The first coil.
constexpr unsigned coils_of(std::string_view id) { return row_called(registers::kBitRegisters, id).first; }
/// The first register.
constexpr unsigned registers_of(std::string_view id) {
  return row_called(registers::kWordRegisters, id).first;
}
/// Of a row with as many registers in all models.
constexpr unsigned size_of(std::string_view id) {
  return static_cast<unsigned>(row_called(registers::kWordRegisters, id).width);
}

}  // namespace ex9000::utility
