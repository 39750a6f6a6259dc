// A board that has exactly the members that hal/board.hpp requires. The functions of the members are declared
// but not defined, because no test calls them.
#pragma once

#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/model/line_format.hpp"
#include "firmware/time.hpp"

namespace ex9000::hal {

struct RightClock {
  [[nodiscard]] static Time now();
  [[nodiscard]] static Time now_in_interrupt();
};

struct RightLine {
  static void open(std::uint32_t baud, LineFormat format);
  static void send(Bytes bytes);
  [[nodiscard]] static bool sending();
};

struct RightTimer {
  static void restart(Duration after);
};

struct RightInputs {
  static std::uint16_t start();
};

struct RightOutputs {
  static void drive(std::uint16_t channels);
};

struct RightMemory {
  static void start_read(std::uint16_t address, MutableBytes destination, Time now);
  static void start_write(std::uint16_t address, Bytes source, Time now);
  static bool poll(Time now);
  [[nodiscard]] static bool busy();
  [[nodiscard]] static bool succeeded();
};

struct RightSwitch {
  [[nodiscard]] static bool asserted();
};

struct RightLed {
  static void light(bool on);
};

struct RightWatchdog {
  static void feed();
};

struct RightBoard {
  RightClock clock;
  RightLine line;
  RightTimer silence_timer;
  RightTimer wake_timer;
  RightInputs inputs;
  RightOutputs outputs;
  RightMemory memory;
  RightSwitch init_switch;
  RightLed status_led;
  RightWatchdog watchdog;
};

}  // namespace ex9000::hal
