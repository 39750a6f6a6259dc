// Must not compile: `drive` accepts only eight channels.
#include "hal/board.hpp"
#include "tests/hal/right_board.hpp"

namespace ex9000::hal {

struct OutputsOfAByte {
  static void drive(std::uint8_t channels);
};
struct BoardOfNarrowOutputs : RightBoard {
  OutputsOfAByte outputs;
};
static_assert(is_board<BoardOfNarrowOutputs>());

}  // namespace ex9000::hal
