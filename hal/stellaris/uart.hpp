// UARTs of LM3S6965 (data sheet, 12.4) and TM4C123GH6PM (data sheet, 14.4), with an RS-485 driver.
#pragma once

#include <cstdint>

#include "hal/pins/single_pins.hpp"
#include "hal/pl011/uart.hpp"

namespace ex9000::hal::stellaris {

/// `number`: 0 or 1; `clock`: system clock in Hz; `driver_enable`: high while sending. See pl011::Uart.
template <unsigned number, std::uint32_t clock, const auto& driver_enable, class EndTimer>
using Uart = pl011::Uart<0x4000'C000U + number * 0x1000U, clock, DriverEnablePin<driver_enable>, EndTimer>;

}  // namespace ex9000::hal::stellaris
