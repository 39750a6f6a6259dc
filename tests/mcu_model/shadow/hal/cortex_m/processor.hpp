// Stands before hal/cortex_m/processor.hpp in the include path of host tests, likewise.
#pragma once

namespace ex9000::hal::cortex_m::processor {

void hold_interrupts();
void release_interrupts();
void wait_for_interrupt();

}  // namespace ex9000::hal::cortex_m::processor
