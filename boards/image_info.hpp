// The information in an image about this image: version, board, model and commit. The linker script puts this
// information directly after the vector table. All images of a family of microcontrollers have a vector table
// of the same size, so they contain the information at the same place in the flash. toolchain/image-info
// reads the information. boards/README.md describes the information.
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

/// The mark, the first text of the information. Change the mark if you change the layout of ImageInfo.
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
