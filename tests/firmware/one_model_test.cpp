// What is compiled for one model, as an image is: EX9000_MODEL is "EX9042D-M" here.
#include <gtest/gtest.h>

#include <array>
#include <cstdint>

#include "firmware/module.hpp"
#include "firmware/settings/record.hpp"
#include "hal/device.hpp"
#include "tests/firmware/constinit.hpp"

namespace ex9000 {
namespace {

/// Peripherals without anything to remember.
struct NoBoard {
  std::uint32_t unused;
};

EX9000_CONSTINIT hal::Device<NoBoard> untouched_device(kOnlyModel, LineTiming::at);

TEST(OneModel, ADeviceIsMadeByTheCompiler) {
  EXPECT_EQ(&untouched_device.module().state().model(), &kOnlyModel);
}

// What an image stores, a program of all models reads, and the other way round.
TEST(OneModel, ItsRecordIsThatOfAllModels) {
  const std::array<std::uint8_t, kRecordSize> from_the_factory{
      1,    6,    0,    1,    0xFF, 0, 0, 0,  // address to timeout status
      '9',  '0',  '4',  '2',  'M',  0, 0, 5,  // name
      0,    0,    0,    0,                    // power-on value, safe value
      1,    0,    2,    0,                    // sequence, layout
      0xD2, 0xC5, 0x25, 0x88,                 // check
  };
  Record record;
  make_record(kOnlyModel, Settings::factory(kOnlyModel), 1, record);
  EXPECT_EQ(record.bytes, from_the_factory);
  EXPECT_TRUE(is_good(kOnlyModel, record));
  record.bytes[kRecordCheckAt] ^= 0x01U;
  EXPECT_FALSE(is_good(kOnlyModel, record));
}

}  // namespace
}  // namespace ex9000
