// From a Cortex-M's reset to main: its vectors, and memory as C++ expects it.
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

/// The linker's, where the stack begins, which grows down.
extern "C" std::uint32_t stack_top[];

/// Copies what is initialised to RAM, clears the rest of what the linker placed there, and calls `main`.
extern "C" [[noreturn]] __attribute__((externally_visible)) void reset_handler();

/// Faults, and interrupts that nobody has asked for: resets the microcontroller at once, which lets go of all
/// outputs.
extern "C" [[noreturn]] void fault_handler();

/// An interrupt and who serves it.
struct Served {
  unsigned number;
  Handler handler;  ///< null: nobody, in this image
};

/// Bit n for interrupt n, of those that somebody serves.
template <class List>
constexpr std::uint32_t numbers_of(const List& list) {
  std::uint32_t numbers = 0;
  for (const Served& served : list) {
    if (served.handler != nullptr) {
      numbers |= 1U << served.number;
    }
  }
  return numbers;
}

/// All that nobody serves is a fault.
template <unsigned interrupts, class List>
constexpr VectorTable<interrupts> vectors(Handler on_system_tick, const List& list) {
  constexpr Handler kFault = fault_handler;
  VectorTable<interrupts> table{stack_top,      reset_handler,
                                kFault,         kFault,
                                kFault,         kFault,
                                kFault,         {kFault, kFault, kFault, kFault},
                                kFault,         kFault,
                                kFault,         kFault,
                                on_system_tick, {}};
  for (Handler& handler : table.interrupt) {
    handler = kFault;
  }
  for (const Served& served : list) {
    if (served.handler != nullptr) {
      table.interrupt[served.number] = served.handler;
    }
  }
  return table;
}

}  // namespace ex9000::start_up

/// The composition's; does not return.
int main();
