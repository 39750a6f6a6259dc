// Tests the functions of boards/pico/run that run_test.cpp does not test: the file of the EEPROM, an
// automatic transceiver, and the baud rate of the master.
#include <gtest/gtest.h>

#include "tests/boards/run/running_image.hpp"

namespace ex9000::system {
namespace {

TEST(PicoRun, AnImageWithAnEepromStoresItsSettingsInTheEepromFile) {
  const Directory directory;
  const std::string image = in_repository(EX9000_IMAGES "-eeprom/EX9043D.elf");
  const Arguments options{"--eeprom", directory / "eeprom"};
  EXPECT_EQ(RunningImage::of_file(image, options).ask("~01OPUMP"), "!01");
  EXPECT_EQ(bytes_of_file(directory / "eeprom").size(), 8192U);
  EXPECT_EQ(RunningImage::of_file(image, options).ask("$01M"), "!01PUMP");
  EXPECT_EQ(RunningImage::of_file(image).ask("$01M"), "!019043D");
}

TEST(PicoRun, AnImageForAnAutomaticTransceiverNeedsNoDriverEnable) {
  const std::string image = in_repository(EX9000_IMAGES "-relay-b/EX9068D-M.elf");
  EXPECT_EQ(RunningImage::of_file(image, {"--init"}).ask("$002"), "!01400600");
}

/// boards/pico/run has no option for the baud rate of the emulated master. In the second run, this master
/// must use the new rate of the module.
TEST(PicoRun, TheMasterUsesTheStoredBaudRateOfTheModule) {
  const Directory directory;
  const Arguments options{"--flash", directory / "flash"};
  Arguments grounded = options;
  grounded.push_back("--init");
  EXPECT_EQ(RunningImage("EX9042D", grounded).ask("%0001400A00"), "!01");
  EXPECT_EQ(RunningImage("EX9042D", options).ask("$012"), "!01400A00");
}

}  // namespace
}  // namespace ex9000::system
