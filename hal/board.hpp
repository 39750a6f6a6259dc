// A board as what its peripherals promise.
#pragma once

#include <type_traits>

#include "hal/clock.hpp"
#include "hal/init_switch.hpp"
#include "hal/inputs.hpp"
#include "hal/memory.hpp"
#include "hal/outputs.hpp"
#include "hal/serial_line.hpp"
#include "hal/silence_timer.hpp"
#include "hal/status_led.hpp"
#include "hal/wake_timer.hpp"
#include "hal/watchdog.hpp"

namespace ex9000::hal {

/// What a board provides: a struct with a member of each of these names, a driver or a reference to one.
/// Where something is missing, the compiler names it.
template <class Board>
constexpr bool is_board() {
  static_assert(kIsClock<std::remove_reference_t<decltype(Board::clock)>>,
                "Board::clock does not offer what hal/clock.hpp says");
  static_assert(kIsSerialLine<std::remove_reference_t<decltype(Board::line)>>,
                "Board::line does not offer what hal/serial_line.hpp says");
  static_assert(kIsSilenceTimer<std::remove_reference_t<decltype(Board::silence_timer)>>,
                "Board::silence_timer does not offer what hal/silence_timer.hpp says");
  static_assert(kIsWakeTimer<std::remove_reference_t<decltype(Board::wake_timer)>>,
                "Board::wake_timer does not offer what hal/wake_timer.hpp says");
  static_assert(kIsInputs<std::remove_reference_t<decltype(Board::inputs)>>,
                "Board::inputs does not offer what hal/inputs.hpp says");
  static_assert(kIsOutputs<std::remove_reference_t<decltype(Board::outputs)>>,
                "Board::outputs does not offer what hal/outputs.hpp says");
  static_assert(kIsMemory<std::remove_reference_t<decltype(Board::memory)>>,
                "Board::memory does not offer what hal/memory.hpp says");
  static_assert(kIsInitSwitch<std::remove_reference_t<decltype(Board::init_switch)>>,
                "Board::init_switch does not offer what hal/init_switch.hpp says");
  static_assert(kIsStatusLed<std::remove_reference_t<decltype(Board::status_led)>>,
                "Board::status_led does not offer what hal/status_led.hpp says");
  static_assert(kIsWatchdog<std::remove_reference_t<decltype(Board::watchdog)>>,
                "Board::watchdog does not offer what hal/watchdog.hpp says");
  return true;
}

/// The same as a question; false too where the board lacks a member.
template <class Board, class = void>
inline constexpr bool kIsBoard = false;
template <class Board>
inline constexpr bool kIsBoard<
    Board, std::void_t<decltype(Board::clock), decltype(Board::line), decltype(Board::silence_timer),
                       decltype(Board::wake_timer), decltype(Board::inputs), decltype(Board::outputs),
                       decltype(Board::memory), decltype(Board::init_switch), decltype(Board::status_led),
                       decltype(Board::watchdog)>> =
    std::conjunction_v<
        std::bool_constant<kIsClock<std::remove_reference_t<decltype(Board::clock)>>>,
        std::bool_constant<kIsSerialLine<std::remove_reference_t<decltype(Board::line)>>>,
        std::bool_constant<kIsSilenceTimer<std::remove_reference_t<decltype(Board::silence_timer)>>>,
        std::bool_constant<kIsWakeTimer<std::remove_reference_t<decltype(Board::wake_timer)>>>,
        std::bool_constant<kIsInputs<std::remove_reference_t<decltype(Board::inputs)>>>,
        std::bool_constant<kIsOutputs<std::remove_reference_t<decltype(Board::outputs)>>>,
        std::bool_constant<kIsMemory<std::remove_reference_t<decltype(Board::memory)>>>,
        std::bool_constant<kIsInitSwitch<std::remove_reference_t<decltype(Board::init_switch)>>>,
        std::bool_constant<kIsStatusLed<std::remove_reference_t<decltype(Board::status_led)>>>,
        std::bool_constant<kIsWatchdog<std::remove_reference_t<decltype(Board::watchdog)>>>>;

}  // namespace ex9000::hal
