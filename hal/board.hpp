// A board as what its peripherals promise.
#pragma once

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

/// What a board provides, for whoever chooses it at run time. An image's board has the same members, of the
/// drivers' own types: then a call of a driver is a call, or nothing at all.
struct Board {
  Clock& clock;
  SerialLine& line;
  SilenceTimer& silence_timer;
  WakeTimer& wake_timer;
  Inputs& inputs;
  Outputs& outputs;
  Memory& memory;
  InitSwitch& init_switch;
  StatusLed& status_led;
  Watchdog& watchdog;
};

}  // namespace ex9000::hal
