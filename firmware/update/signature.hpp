// What an image is for: a model on a board.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/model/model.hpp"
#include "firmware/update/slot.hpp"

namespace ex9000::update {

/// The designation without `EX` and `-` as in register 0x00C8, a dot, and the code of the board, e.g.
/// "9042DM.pico"; padded with 0. In a constant expression, a text that is too long is an error.
constexpr std::array<std::uint8_t, kSignatureSize> signature_of(const Model& model, std::string_view board) {
  constexpr std::size_t kFamily = 2;
  std::array<std::uint8_t, kSignatureSize> signature{};
  std::size_t at = 0;
  for (const char character : model.designation.substr(kFamily)) {
    if (character != '-') {
      signature[at++] = static_cast<std::uint8_t>(character);
    }
  }
  signature[at++] = '.';
  for (const char character : board) {
    signature[at++] = static_cast<std::uint8_t>(character);
  }
  return signature;
}

}  // namespace ex9000::update
