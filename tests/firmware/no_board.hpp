// A board without hardware, for a device that is compiled but never runs.
#pragma once

#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/line/timing.hpp"
#include "firmware/model/line_format.hpp"
#include "firmware/settings/memory_job.hpp"
#include "firmware/time.hpp"

namespace ex9000 {

/// Stands for each peripheral. It has no state, and none of its functions is called.
struct Nothing {
  [[nodiscard]] static Time now();
  [[nodiscard]] static Time now_in_interrupt();
  static LineTiming timing(std::uint32_t baud, LineFormat format);
  static void open(std::uint32_t baud, LineFormat format);
  static void send(Bytes bytes);
  [[nodiscard]] static bool sending();
  static void restart(Duration after);
  static void drive(std::uint16_t channels);
  static void start(const MemoryJob& job, Time now);
  static bool poll(Time now);
  [[nodiscard]] static bool busy();
  [[nodiscard]] static MemoryResult result();
  [[nodiscard]] static bool asserted();
  static void light(bool on);
  static void feed();
  static std::uint16_t start();
};
struct NoBoard {
  Nothing clock;
  Nothing line;
  Nothing silence_timer;
  Nothing wake_timer;
  Nothing inputs;
  Nothing outputs;
  Nothing memory;
  Nothing init_switch;
  Nothing status_led;
  Nothing watchdog;
};

}  // namespace ex9000
