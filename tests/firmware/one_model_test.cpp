// Tests code that is compiled for one model, as in an image: EX9000_MODEL is "EX9042D-M" here.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "firmware/module.hpp"
#include "firmware/settings/record.hpp"
#include "hal/device.hpp"
#include "tests/firmware/constinit.hpp"
#include "tests/firmware/no_board.hpp"

namespace ex9000 {
namespace {

EX9000_CONSTINIT hal::Device<NoBoard> untouched_device(kOnlyModel);

TEST(OneModel, ADeviceIsInitialisedAtCompileTime) {
  EXPECT_EQ(&untouched_device.module().state().model(), &kOnlyModel);
}

// A program for all models must be able to read the settings that an image stores. An image must be able to
// read the settings that a program for all models stores. tests/firmware/settings/record_test.cpp checks the
// same bytes in a program for all models.
TEST(OneModel, ItsRecordIsTheSameAsInAProgramForAllModels) {
  const std::vector<std::uint8_t> from_the_factory{
      1,    19,   1,    0,                    // layout, length, sequence
      1,    6,    0,    1,    0xFF, 0, 0,     // from the address to the timeout status
      '9',  '0',  '4',  '2',  'M',  0, 0, 5,  // name
      0,    0,    0,    0,                    // power-on value, safe value
      0xA5, 0xB3, 0xBF, 0xDE,                 // check
  };
  RecordBytes record{};
  write_record(kOnlyModel, Settings::factory(kOnlyModel), 1, record);
  EXPECT_TRUE(std::equal(from_the_factory.begin(), from_the_factory.end(), record.begin()));
  EXPECT_TRUE(read_record(kOnlyModel, {record.data(), record.size()}));
  record[from_the_factory.size() - 1] ^= 0x01U;
  EXPECT_FALSE(read_record(kOnlyModel, {record.data(), record.size()}));
}

}  // namespace
}  // namespace ex9000
