// Tests images for the Pico in the emulator. These images store the settings in an external EEPROM.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "boards/pico/board.hpp"
#include "tests/boards/pico_image.hpp"

namespace ex9000::pico {
namespace {

class PicoWithEeprom : public PicoImage {
 protected:
  PicoWithEeprom() : PicoImage(Memory::Eeprom) {}
};

TEST_F(PicoWithEeprom, APowerFailureDuringAStoreLeavesTheOldOrTheNewName) {
  std::map<std::string, int> names;
  for (int cut = 0; cut < 60; ++cut) {
    begin();
    ASSERT_EQ(ask("~01OOLD"), "!01\r");
    bench_.send(text("~01ONEW\r"));
    bench_.run_for(std::chrono::microseconds(500) * cut);
    bench_.power(false);
    bench_.run_for(milliseconds(10));
    bench_.power(true);
    bench_.run_for(kComingUp);
    bench_.heard();
    ++names[ask("$01M")];
  }
  EXPECT_GT(names["!01OLD\r"], 0);
  EXPECT_GT(names["!01NEW\r"], 0);
  EXPECT_EQ(names.size(), 2U);
}

/// The bytes on the bus and the programming of the page take 11 ms. Without the interrupt of the I2C master,
/// each step would wait up to 1 ms longer, until the main loop polls the memory.
TEST_F(PicoWithEeprom, AReplyToAStoreBeginsWithoutWaitingForThePollOfTheMemory) {
  begin("EX9043D-M", 115200);
  const nanoseconds bit(1'000'000'000 / 115200);
  for (int i = 0; i < 10; ++i) {
    const nanoseconds waited = turn_around(bench_, text(i % 2 == 0 ? "~01OVALVE\r" : "~01OPUMP\r"), bit);
    EXPECT_LE(waited, milliseconds(12)) << i;
  }
}

TEST_F(PicoWithEeprom, AnEepromThatBlocksTheBusDoesNotStopTheModule) {
  begin();
  bench_.execute("pin " + std::to_string(board::kI2cPins.first_pin) + " low");
  bench_.execute("absent");
  EXPECT_EQ(ask("~01OVALVE"), "?01\r");
  EXPECT_EQ(ask("$01M"), "!019043M\r");
  bench_.power(false);
  bench_.power(true);
  bench_.run_for(milliseconds(1000));
  EXPECT_EQ(bench_.counts().at("timeouts"), 0);
}

TEST_F(PicoWithEeprom, DuringAStartTheModuleFreesABusThatTheEepromHolds) {
  const unsigned data = board::kI2cPins.first_pin;
  begin();
  bench_.power(false);
  bench_.execute("pin " + std::to_string(data) + " low");
  bench_.power(true);
  // The EEPROM releases the data line after nine clocks, as if a reset had interrupted a read.
  constexpr int kEdges = 2 * 9;
  for (int edge = 0; edge < kEdges; ++edge) {
    ASSERT_EQ(bench_.execute("watch " + std::to_string(data + 1) + " 100000000"), "1") << edge;
  }
  bench_.execute("pin " + std::to_string(data) + " high");
  bench_.run_for(kComingUp);
  EXPECT_EQ(bench_.outputs(), kPowerOnValue) << "the settings have not been read";
  EXPECT_EQ(ask("~01OVALVE"), "!01\r");
}

TEST_F(PicoWithEeprom, AModuleWithoutAnEepromWorksWithFactorySettings) {
  const Model& model = *find_model("EX9043D");
  bench_.begin_anew(model, nullptr);
  bench_.execute("absent");
  bench_.power(true);
  bench_.run_for(milliseconds(1000));
  EXPECT_EQ(ask("$01M"), "!019043D\r");
  EXPECT_EQ(ask("~01OVALVE"), "?01\r");
  EXPECT_EQ(bench_.counts().at("timeouts"), 0);
}

}  // namespace
}  // namespace ex9000::pico
