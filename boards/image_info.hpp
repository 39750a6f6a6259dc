// What an image says about itself: version, board, model and commit. The linker script puts this information
// directly after the vector table, so its place in the flash is the same for all images of a family of
// processors. toolchain/image-info reads it. boards/README.md describes it.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace ex9000::board {

/// A text of at most `size` characters. The unused characters at the end are NUL.
template <std::size_t size>
struct InfoText {
  std::array<char, size> characters{};

  /// Call this only in a constant expression. The compiler then rejects a text that is too long.
  constexpr InfoText(std::string_view text) {  // NOLINT(google-explicit-constructor)
    for (std::size_t index = 0; index < text.size(); ++index) {
      characters[index] = text[index];
    }
  }
};

/// The beginning of the information. Another layout must have another mark.
inline constexpr std::string_view kImageMark = "EX9INFO1";

struct ImageInfo {
  InfoText<8> mark;
  InfoText<8> version;
  InfoText<24> board;
  InfoText<16> model;
  InfoText<40> commit;
};
static_assert(sizeof(ImageInfo) == 96, "toolchain/image_info/info.py reads 96 bytes");

}  // namespace ex9000::board
