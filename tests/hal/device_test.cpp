// Tests that the device polls the memory immediately after it has begun a job: hal/memory.hpp.
#include "hal/device.hpp"

#include <gtest/gtest.h>

#include <initializer_list>

#include <cstdint>

#include "firmware/line/timing.hpp"
#include "hal/doubles/kept_word.hpp"
#include "hal/doubles/no_image_slots.hpp"
#include "tests/support/instant_memory.hpp"

namespace ex9000::hal {
namespace {

/// A board on which no interrupt occurs, and only the test lets time pass.
struct StillBoard {
  struct Clock {
    Time time;
    [[nodiscard]] Time now() const { return time; }
    [[nodiscard]] Time now_in_interrupt() const { return time; }
  };
  struct Line {
    static LineTiming timing(std::uint32_t baud, LineFormat format) {
      return LineTiming::strictly_at(baud, format);
    }
    static void open(std::uint32_t /*baud*/, LineFormat /*format*/) {}
    static void send(Bytes /*bytes*/) {}
    static void send_in_interrupt(Bytes /*bytes*/) {}
    static bool sending() { return true; }
    static bool low() { return false; }
  };
  struct Timer {
    unsigned restarts = 0;
    void restart(Duration /*after*/) { ++restarts; }
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
    static void restart() {}
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
  doubles::KeptWord kept_word;
  doubles::NoImageSlots slots;
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

// wire.md D11. If gaps are limited, the silence after a host OK takes two runs of the silence timer. A reply
// may begin during the first one.
TEST(Device, TheSilenceTimerRunsToTheEndOfTheSilenceEvenDuringAReply) {
  Device<StillBoard> device(*find_model("EX9042D-M"), StillBoard());
  device.start(ResetReason::PowerOn);
  while (device.turn()) {
  }
  device.board().clock.time = Time(60'000);
  while (device.turn()) {
  }
  ASSERT_TRUE(device.module().listening());
  for (const std::uint8_t byte :
       std::initializer_list<std::uint8_t>{0x01, 0x03, 0x30, 0x38, 0x00, 0x00, 0xCB, 0x07}) {
    device.on_receive(byte, ByteStatus::Good);
  }
  EXPECT_FALSE(device.module().frame_waits());
  const unsigned restarts = device.board().silence_timer.restarts;
  device.on_silence();
  EXPECT_EQ(device.board().silence_timer.restarts, restarts + 1);
  device.on_silence();
  EXPECT_TRUE(device.module().frame_waits());
}

}  // namespace
}  // namespace ex9000::hal
