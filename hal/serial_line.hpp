#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include "firmware/bytes.hpp"
#include "hal/promise.hpp"

namespace ex9000::hal {

/// The UART and the RS-485 driver behind it, 8N1, half duplex.
///
/// What it receives it hands to `Device::on_receive` in its receive interrupt, errors included; but nothing
/// while the driver is on, for that is the echo. That it has sent it tells `Device::on_sent`, in an interrupt
/// of the same priority.
///
///     void open(std::uint32_t baud)
///         Starts receiving at `baud` bits per second (1200 to 115200). Before it, the line is neither heard
///         nor driven. Main loop, once after reset; does not block.
///     void send(Bytes bytes)
///         Driver on, then all of `bytes`, then driver off. The driver is on before the first start bit, and
///         off after the last stop bit has left the shift register (transmission complete, not "data register
///         empty"), within one character time. Main loop, only while not `sending()`; does not block. `bytes`
///         live until `sending()` is false again.
///     bool sending() const
///         Whether the driver is on. Interrupts and main loop.
///
/// Whether `T` offers that.
template <class T, class = void>
inline constexpr bool kIsSerialLine = false;
template <class T>
inline constexpr bool
    kIsSerialLine<T, std::void_t<Returns<void, decltype(std::declval<T&>().open(Exactly<std::uint32_t>()))>,
                                 Returns<void, decltype(std::declval<T&>().send(Exactly<Bytes>()))>,
                                 Returns<bool, decltype(std::declval<const T&>().sending())>>> = true;

}  // namespace ex9000::hal
