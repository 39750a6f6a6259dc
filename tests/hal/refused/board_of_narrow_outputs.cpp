// Must not compile: `drive` would drop the channels from 8 on.
#include "hal/device.hpp"
#include "tests/firmware/no_board.hpp"

struct NarrowOutputs {
  static void drive(std::uint8_t channels);
};
struct BoardOfNarrowOutputs : ex9000::NoBoard {
  NarrowOutputs outputs;
};
template class ex9000::hal::Device<BoardOfNarrowOutputs>;
