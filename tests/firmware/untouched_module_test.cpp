// A module before `begin`: the compiler has made it, of zeros, so that no code has to.
#include <gtest/gtest.h>

#include "firmware/module.hpp"
#include "hal/board.hpp"
#include "hal/device.hpp"
#include "tests/firmware/made_of_zeros.hpp"

namespace ex9000 {
namespace {

constexpr const Model& kModel = kModels[0];

/// Peripherals without anything to remember.
struct NoBoard {
  std::uint32_t unused;
};

EX9000_CONSTINIT Module untouched_module(kModel);
EX9000_CONSTINIT hal::Device<NoBoard> untouched_device(kModel);

/// The store and the state each refer to the model, where one of many may be chosen.
constexpr std::size_t kReferencesToTheModel = 2;

TEST(UntouchedModule, IsZerosButForItsModel) {
  EXPECT_EQ(words_other_than_0(untouched_module), kReferencesToTheModel);
  EXPECT_EQ(&untouched_module.state().model(), &kModel);
}

TEST(UntouchedModule, SoIsADevice) {
  EXPECT_EQ(words_other_than_0(untouched_device), kReferencesToTheModel);
  EXPECT_EQ(&untouched_device.module().state().model(), &kModel);
}

TEST(UntouchedModule, DrivesNothingAndWantsNothing) {
  EXPECT_EQ(untouched_module.outputs(), 0);
  EXPECT_FALSE(untouched_module.wants_memory());
  EXPECT_FALSE(untouched_module.request_waits());
}

}  // namespace
}  // namespace ex9000
