// What takes an instruction of its own. Facts: ARMv7-M Architecture Reference Manual, B5.2 and A7.7.
#pragma once

namespace ex9000::hal::cortex_m::processor {

/// Interrupts wait until they are released; faults do not. Main loop.
inline void hold_interrupts() { __asm volatile("cpsid i" ::: "memory"); }
/// Those that wait are served before the next instruction, also where that holds them again.
inline void release_interrupts() { __asm volatile("cpsie i\n\tisb" ::: "memory"); }

/// Sleeps until an interrupt is pending, held or not. Main loop.
inline void wait_for_interrupt() { __asm volatile("wfi" ::: "memory"); }

}  // namespace ex9000::hal::cortex_m::processor
