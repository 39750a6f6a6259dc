// The start of a Cortex-M from reset to `main`: the vector table, and the initialisation of the variables in
// RAM.
#pragma once

#include <cstdint>

namespace ex9000::start_up {

using Handler = void (*)();

/// The vector table of a Cortex-M (ARMv7-M Architecture Reference Manual, B1.5.3): the initial stack pointer,
/// the system exceptions, and the interrupts by number.
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

/// The beginning of the stack, which grows down. The linker script defines this symbol.
extern "C" std::uint32_t stack_top[];

/// Initialises the variables in RAM, and calls `main`. On the RP2040, this function initialises only the
/// variables whose initial value is zero, because the second stage has copied the others to RAM.
extern "C" [[noreturn]] __attribute__((externally_visible)) void reset_handler();

/// Handles faults and unexpected interrupts: resets the microcontroller immediately. The reset switches all
/// outputs off.
extern "C" [[noreturn]] void fault_handler();

/// An interrupt and its handler.
struct Served {
  unsigned number;
  Handler handler;  ///< null if this image does not use the interrupt
};

/// Returns the interrupts that have a handler; bit n is interrupt n.
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

/// Returns the vector table. `on_system_tick`: the handler of the system tick. `list`: the interrupts that
/// the image may use. If an exception or an interrupt has no other handler, its handler is `fault_handler`.
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

/// Does not return. In an image, the composition file defines `main`, which starts the drivers and runs the
/// main loop.
int main();
