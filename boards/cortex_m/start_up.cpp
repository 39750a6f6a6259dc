#include "boards/cortex_m/start_up.hpp"

#include "hal/cortex_m/interrupts.hpp"

namespace ex9000::start_up {

// Symbols of the linker script. Each is the beginning or the end of an array of words.
extern "C" const std::uint32_t data_image[];
extern "C" std::uint32_t data_begin[];
extern "C" std::uint32_t data_end[];
extern "C" std::uint32_t zero_begin[];
extern "C" std::uint32_t zero_end[];

extern "C" void reset_handler() {
  const std::uint32_t* from = data_image;
  for (std::uint32_t* word = data_begin; word != data_end; ++word) {
    *word = *from++;
  }
  for (std::uint32_t* word = zero_begin; word != zero_end; ++word) {
    *word = 0;
  }
  main();
  fault_handler();
}

extern "C" void fault_handler() { hal::cortex_m::Interrupts::reset(); }

}  // namespace ex9000::start_up
