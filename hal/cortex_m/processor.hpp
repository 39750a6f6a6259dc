// Special instructions. Sources: ARMv7-M Architecture Reference Manual, B5.2, A7.7; ARMv6-M, B4.2, A6.7.
#pragma once

namespace ex9000::hal::cortex_m::processor {

/// But not faults. For the main loop.
inline void disable_interrupts() { __asm volatile("cpsid i" ::: "memory"); }
/// Pending interrupts run before the next instruction, even if that disables them again.
inline void enable_interrupts() { __asm volatile("cpsie i\n\tisb" ::: "memory"); }

/// For the main loop. A pending interrupt ends the sleep even if interrupts are disabled.
inline void wait_for_interrupt() { __asm volatile("wfi" ::: "memory"); }

}  // namespace ex9000::hal::cortex_m::processor
