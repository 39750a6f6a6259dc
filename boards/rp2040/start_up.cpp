// The start of an image after the second stage, which has copied the image to RAM.
#include "boards/cortex_m/start_up.hpp"
#include "hal/rp2040/watchdog.hpp"

namespace ex9000::start_up {

// Symbols of the linker script. Each is the beginning or the end of an array of words.
extern "C" std::uint32_t zero_begin[];
extern "C" std::uint32_t zero_end[];

extern "C" void reset_handler() {
  for (std::uint32_t* word = zero_begin; word != zero_end; ++word) {
    *word = 0;
  }
  main();
  fault_handler();
}

/// Resets the chip, except its oscillators, through the watchdog, because a reset request of the processor
/// would not reset the pins.
extern "C" void fault_handler() { hal::rp2040::WatchdogRegisters::reset_chip(); }

}  // namespace ex9000::start_up
