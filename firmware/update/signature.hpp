// What an image is for: a model on a board.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "firmware/model/model.hpp"
#include "firmware/update/slot.hpp"

namespace ex9000::update {

using Signature = std::array<std::uint8_t, kSignatureSize>;

/// The short designation, a dot, and the code of the board, e.g. "9042DM.pico"; padded with 0. In a constant
/// expression, a text that is too long is an error.
constexpr Signature signature_of(const Model& model, std::string_view board) {
  Signature signature{};
  unsigned at = 0;
  while (model.short_designation(at) != 0) {
    signature[at] = model.short_designation(at);
    ++at;
  }
  signature[at++] = '.';
  for (const char character : board) {
    signature[at++] = static_cast<std::uint8_t>(character);
  }
  return signature;
}

}  // namespace ex9000::update
