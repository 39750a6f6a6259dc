// A board whose numbers of pins come from the command line of the compiler. The board does not suit the model
// from that command line, or there are fewer images than models.
#include <array>

namespace ex9000::board {

struct Pins {
  unsigned count;
};
constexpr std::array<Pins, 1> kOutputs{{{OUTPUT_PINS}}};
constexpr std::array<Pins, 1> kInputs{{{INPUT_PINS}}};

}  // namespace ex9000::board

#include "boards/image.hpp"
