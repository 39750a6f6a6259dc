// A module before `start`: the compiler makes it, valid from its first moment on, and no code has to.
#include <gtest/gtest.h>

#include "firmware/module.hpp"
#include "hal/device.hpp"
#include "tests/firmware/constinit.hpp"

namespace ex9000 {
namespace {

constexpr const Model& kModel = kModels[0];

/// Peripherals without anything to remember; none of their functions is called.
struct Nothing {
  [[nodiscard]] static Time now();
  [[nodiscard]] static Time now_in_interrupt();
  static void open(std::uint32_t baud);
  static void send(Bytes bytes);
  [[nodiscard]] static bool sending();
  static void restart(Duration after);
  static void drive(std::uint16_t channels);
  static void start_read(std::uint16_t address, MutableBytes destination, Time now);
  static void start_write(std::uint16_t address, Bytes source, Time now);
  static bool poll(Time now);
  [[nodiscard]] static bool busy();
  [[nodiscard]] static bool succeeded();
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

EX9000_CONSTINIT Module untouched_module(kModel);
EX9000_CONSTINIT hal::Device<NoBoard> untouched_device(kModel, LineTiming::at);

TEST(UntouchedModule, IsItsModel) {
  EXPECT_EQ(&untouched_module.state().model(), &kModel);
  EXPECT_EQ(&untouched_device.module().state().model(), &kModel);
}

TEST(UntouchedModule, DrivesNothingAndDoesNotListen) {
  EXPECT_EQ(untouched_module.outputs(), 0);
  EXPECT_FALSE(untouched_module.listening());
  EXPECT_FALSE(untouched_module.request_waits());
  EXPECT_TRUE(untouched_module.led_lit());
}

TEST(UntouchedModule, HasItsSettingsToReadAndNobodyHasReadItsResetStatus) {
  EXPECT_TRUE(untouched_module.needs_memory());
  EXPECT_TRUE(untouched_module.state().reset_status);
}

}  // namespace
}  // namespace ex9000
