// A board whose numbers of pins come from the command line of the compiler. The board has too few pins for
// the model from that command line, or EX9000_IMAGES, the number of images from the command line, is not the
// number of models.
#include <array>

namespace ex9000::board {

struct Pins {
  unsigned count;
};
constexpr std::array<Pins, 1> kOutputs{{{OUTPUT_PINS}}};
constexpr std::array<Pins, 1> kInputs{{{INPUT_PINS}}};

}  // namespace ex9000::board

#include "boards/image.hpp"
