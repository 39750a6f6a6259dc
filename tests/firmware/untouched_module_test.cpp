// Tests a module for which `start` has not been called. The compiler initialises the module, so the module is
// valid before any code of the program runs.
#include <gtest/gtest.h>

#include "firmware/module.hpp"
#include "hal/device.hpp"
#include "tests/firmware/constinit.hpp"
#include "tests/firmware/no_board.hpp"

namespace ex9000 {
namespace {

constexpr const Model& kModel = kModels[0];

EX9000_CONSTINIT Module untouched_module(kModel);
EX9000_CONSTINIT hal::Device<NoBoard> untouched_device(kModel);

TEST(UntouchedModule, HasTheModelOfItsConstructor) {
  EXPECT_EQ(&untouched_module.state().model(), &kModel);
  EXPECT_EQ(&untouched_device.module().state().model(), &kModel);
}

TEST(UntouchedModule, DrivesNoOutputDoesNotListenHasNoRequestAndLightsItsLed) {
  EXPECT_EQ(untouched_module.outputs(), 0);
  EXPECT_FALSE(untouched_module.listening());
  EXPECT_FALSE(untouched_module.frame_waits());
  EXPECT_TRUE(untouched_module.led_lit());
}

TEST(UntouchedModule, MustReadItsSettingsAndHasAnUnreadResetStatus) {
  EXPECT_TRUE(untouched_module.needs_memory());
  EXPECT_TRUE(untouched_module.state().reset_status);
}

}  // namespace
}  // namespace ex9000
