// Host tests include this file instead of hal/cortex_m/processor.hpp; its functions call
// registers::Microcontroller.
#pragma once

namespace ex9000::hal::cortex_m::processor {

void disable_interrupts();
void enable_interrupts();
void wait_for_interrupt();

}  // namespace ex9000::hal::cortex_m::processor
