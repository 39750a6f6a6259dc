// A board that the compiler must refuse. The command line of the compiler defines the model, the numbers of
// pins of the board, and in one test EX9000_IMAGES, the number of images. Either the board has too few pins
// for the model, or EX9000_IMAGES differs from the number of models.
#include <array>

namespace ex9000::board {

struct Pins {
  unsigned count;
};
constexpr std::array<Pins, 1> kOutputs{{{OUTPUT_PINS}}};
constexpr std::array<Pins, 1> kInputs{{{INPUT_PINS}}};

}  // namespace ex9000::board

#include "boards/image.hpp"
