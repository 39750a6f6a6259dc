// Tests the functions of boards/pico/run that run_test.cpp does not test: the file of the EEPROM, the baud
// rate of the master, and the error if Node.js is missing.
#include <gtest/gtest.h>

#include <cstdlib>

#include "tests/boards/run/running_image.hpp"

namespace ex9000::system {
namespace {

TEST(PicoRun, AnImageWithAnEepromStoresItsSettingsInTheEepromFile) {
  const Directory directory;
  const std::string image = EX9000_IMAGES "-eeprom/EX9043D.elf";
  const Arguments options{"--eeprom", directory / "eeprom"};
  EXPECT_EQ(RunningImage::of_file(image, options).ask("~01OPUMP"), "!01");
  EXPECT_EQ(bytes_of_file(directory / "eeprom").size(), 8192U);
  EXPECT_EQ(RunningImage::of_file(image, options).ask("$01M"), "!01PUMP");
  EXPECT_EQ(RunningImage::of_file(image).ask("$01M"), "!019043D");
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

TEST(PicoRun, NamesTheMissingPackage) {
  const Directory directory;
  const std::string path = getenv("PATH");
  setenv("PATH", directory.path().c_str(), 1);
  expect_refusal(directory, {image_of("EX9042D")}, {"install the package nodejs"});
  setenv("PATH", path.c_str(), 1);
}

}  // namespace
}  // namespace ex9000::system
