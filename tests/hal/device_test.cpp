// Tests that the device polls the memory immediately after it has begun a job: hal/memory.hpp.
#include "hal/device.hpp"

#include <gtest/gtest.h>

#include <cstdint>

#include "firmware/line/timing.hpp"
#include "tests/support/instant_memory.hpp"

namespace ex9000::hal {
namespace {

/// A board on which no time passes and no interrupt occurs.
struct StillBoard {
  struct Clock {
    static Time now() { return {}; }
    static Time now_in_interrupt() { return {}; }
  };
  struct Line {
    static LineTiming timing(std::uint32_t baud, LineFormat format) { return LineTiming::at(baud, format); }
    static void open(std::uint32_t /*baud*/, LineFormat /*format*/) {}
    static void send(Bytes /*bytes*/) {}
    static bool sending() { return false; }
  };
  struct Timer {
    static void restart(Duration /*after*/) {}
  };
  struct Inputs {
    static std::uint16_t start() { return 0; }
  };
  struct Outputs {
    static void drive(std::uint16_t /*channels*/) {}
  };
  struct Switch {
    static bool asserted() { return false; }
  };
  struct Led {
    static void light(bool /*on*/) {}
  };
  struct Watchdog {
    static void feed() {}
  };

  Clock clock;
  Line line;
  Timer silence_timer;
  Timer wake_timer;
  Inputs inputs;
  Outputs outputs;
  InstantMemory memory;
  Switch init_switch;
  Led status_led;
  Watchdog watchdog;
};

TEST(Device, AJobThatTheMemoryCompletesAtOnceWaitsForNoPoll) {
  Device<StillBoard> device(*find_model("EX9042D-M"), StillBoard());
  device.start(ResetReason::PowerOn);
  for (int turns = 0; device.turn() || device.has_work(); ++turns) {
    ASSERT_LT(turns, 100);
  }
  EXPECT_FALSE(device.module().needs_memory()) << "loading waits for a poll";
  EXPECT_EQ(device.board().memory.jobs, 1U);
}

}  // namespace
}  // namespace ex9000::hal
