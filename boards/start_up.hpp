// From the processor's reset to main: memory as C++ expects it.
#pragma once

#include <cstdint>

namespace ex9000::start_up {

using Handler = void (*)();

/// What the processor reads from address 0 on (ARMv7-M Architecture Reference Manual, B1.5.3): the stack
/// pointer at reset, the system exceptions, then the interrupts by their numbers.
template <unsigned interrupts>
struct VectorTable {
  const void* stack_top;
  Handler reset;
  Handler non_maskable;
  Handler hard_fault;
  Handler memory_fault;
  Handler bus_fault;
  Handler usage_fault;
  Handler reserved_7_to_10[4];
  Handler supervisor_call;
  Handler debug_monitor;
  Handler reserved_13;
  Handler pended_call;
  Handler system_tick;
  Handler interrupt[interrupts];
};

/// The linker's; only its address counts.
extern "C" std::uint32_t stack_top;

/// Copies what is initialised to RAM, clears the rest of what the linker placed there, and calls `main`.
extern "C" [[noreturn]] __attribute__((externally_visible)) void reset_handler();

/// Faults, and interrupts that nobody has asked for: resets the microcontroller at once, which lets go of all
/// outputs.
extern "C" [[noreturn]] void fault_handler();

}  // namespace ex9000::start_up

/// The composition's; does not return.
int main();
