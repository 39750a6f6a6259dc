// Functions that need special instructions. Sources: ARMv7-M Architecture Reference Manual, B5.2 and A7.7;
// ARMv6-M Architecture Reference Manual, B4.2 and A6.7.
#pragma once

namespace ex9000::hal::cortex_m::processor {

/// Disables interrupts, but not faults, until `enable_interrupts`. For the main loop.
inline void disable_interrupts() { __asm volatile("cpsid i" ::: "memory"); }
/// Enables interrupts. Pending interrupts run before the next instruction, even if that instruction disables
/// them again.
inline void enable_interrupts() { __asm volatile("cpsie i\n\tisb" ::: "memory"); }

/// Sleeps until an interrupt is pending. A pending interrupt ends the sleep even if interrupts are disabled.
/// For the main loop.
inline void wait_for_interrupt() { __asm volatile("wfi" ::: "memory"); }

}  // namespace ex9000::hal::cortex_m::processor
