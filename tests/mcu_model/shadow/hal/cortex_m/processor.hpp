// Some host tests, and the images that they load, include this file instead of hal/cortex_m/processor.hpp.
// tests/mcu_model/microcontroller.cpp defines these functions.
#pragma once

namespace ex9000::hal::cortex_m::processor {

void disable_interrupts();
void enable_interrupts();
void wait_for_interrupt();

}  // namespace ex9000::hal::cortex_m::processor
