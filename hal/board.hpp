// Checks that a board has the peripherals that `Device` accesses, and that they have the required functions.
// The composition file of each board checks the tick of this board.
#pragma once

#include <type_traits>

#include "hal/clock.hpp"
#include "hal/init_switch.hpp"
#include "hal/inputs.hpp"
#include "hal/memory.hpp"
#include "hal/one_shot_timer.hpp"
#include "hal/outputs.hpp"
#include "hal/serial_line.hpp"
#include "hal/status_led.hpp"
#include "hal/watchdog.hpp"

namespace ex9000::hal {

/// Returns true if `Board` is a struct with the members that are listed below. Each member is a driver or a
/// reference to a driver. If a member is missing, lacks a required function or has one with a wrong
/// signature, compilation fails with a message that names the member.
// NOLINTBEGIN(bugprone-macro-parentheses): the arguments are names
template <class Board>
constexpr bool is_board() {
#define EX9000_REQUIRE(member, promise, header)                            \
  static_assert(promise<std::remove_reference_t<decltype(Board::member)>>, \
                "Board::" #member                                          \
                ": lacks a function, or a function has a wrong signature; see hal/" header)
  EX9000_REQUIRE(clock, kIsClock, "clock.hpp");
  EX9000_REQUIRE(line, kIsSerialLine, "serial_line.hpp");
  EX9000_REQUIRE(silence_timer, kIsOneShotTimer, "one_shot_timer.hpp");
  EX9000_REQUIRE(wake_timer, kIsOneShotTimer, "one_shot_timer.hpp");
  EX9000_REQUIRE(inputs, kIsInputs, "inputs.hpp");
  EX9000_REQUIRE(outputs, kIsOutputs, "outputs.hpp");
  EX9000_REQUIRE(memory, kIsMemory, "memory.hpp");
  EX9000_REQUIRE(init_switch, kIsInitSwitch, "init_switch.hpp");
  EX9000_REQUIRE(status_led, kIsStatusLed, "status_led.hpp");
  EX9000_REQUIRE(watchdog, kIsWatchdog, "watchdog.hpp");
#undef EX9000_REQUIRE
  return true;
}
// NOLINTEND(bugprone-macro-parentheses)

}  // namespace ex9000::hal
