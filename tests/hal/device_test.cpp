// Tests how the device uses a memory that completes a job at once: hal/memory.hpp.
#include "hal/device.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "firmware/line/timing.hpp"
#include "firmware/settings/places.hpp"

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
  struct Memory {
    std::vector<std::uint8_t> cells = std::vector<std::uint8_t>(1024, 0xFF);
    unsigned jobs = 0;
    void start_read(std::uint16_t address, MutableBytes destination, Time /*now*/) {
      std::copy_n(cells.begin() + address, destination.size, destination.data);
      ++jobs;
    }
    void start_write(std::uint16_t address, Bytes source, Time /*now*/) {
      std::copy(source.begin(), source.end(), cells.begin() + address);
      ++jobs;
    }
    static bool poll(Time /*now*/) { return false; }
    static bool busy() { return false; }
    static bool succeeded() { return true; }
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
  Memory memory;
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
  EXPECT_EQ(device.board().memory.jobs, kPlaces.size());  // one read of each blank place
}

}  // namespace
}  // namespace ex9000::hal
