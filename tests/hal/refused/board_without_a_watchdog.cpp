// Must not compile: the board does not have a watchdog.
#include "hal/board.hpp"
#include "tests/hal/right_board.hpp"

namespace ex9000::hal {

struct BoardWithoutAWatchdog {
  RightClock clock;
  RightLine line;
  RightTimer silence_timer;
  RightTimer wake_timer;
  RightInputs inputs;
  RightOutputs outputs;
  RightMemory memory;
  RightSwitch init_switch;
  RightLed status_led;
};
static_assert(is_board<BoardWithoutAWatchdog>());

}  // namespace ex9000::hal
