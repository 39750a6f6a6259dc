// Tests the text of a module's face, and the texts about changes of the face.
#include "sim/front_ends/terminal_view/face_text.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <string>
#include <vector>

#include "tests/firmware/module_bench.hpp"

namespace ex9000::sim {
namespace {

using Lines = std::vector<std::string>;
using std::chrono::milliseconds;

Lines shown(ModuleBench& bench, const Lamps& lamps = kPlainLamps) {
  return face_text(1, bench.module(), bench.now(), lamps);
}

TEST(FaceText, ShowsAModuleWithOutputs) {
  ModuleBench bench("EX9042D@2A,checksum=off,name=PUMPS");
  ASSERT_EQ(bench.ask("@2A1005"), ">");
  EXPECT_EQ(shown(bench), (Lines{
                              "1  EX9042D     PUMPS   2A DCON 9600 8N1          LED * on       power on",
                              "   DO      0  1  2  3  4  5  6  7  8  9  10 11 12",
                              "           *  -  *  -  -  -  -  -  -  -  -  -  *",
                              "   power-on 0000, safe 0000",
                              "   host watchdog off",
                          }));
}

TEST(FaceText, ShowsAModuleWithInputs) {
  ModuleBench bench("EX9052D-M@02,edge=rising");
  bench.module().set_input(1, true);
  bench.module().pulse_input(7, 12);
  EXPECT_EQ(shown(bench), (Lines{
                              "1  EX9052D-M   9052M   02 Modbus RTU 9600 8N1    LED * on       power on",
                              "   DI      0  1  2  3  4  5  6  7",
                              "           -  *  -  -  -  -  -  -",
                              "   counters 0 1 0 0 0 0 0 12",
                              "   latched high 82, low 80",
                              "   host watchdog off",
                          }));
}

TEST(FaceText, ShowsAModuleWithOutputsAndInputs) {
  ModuleBench bench("EX9055D");
  const Lines lines = shown(bench);
  ASSERT_EQ(lines.size(), 9U);
  EXPECT_EQ(lines[1], "   DO      0  1  2  3  4  5  6  7");
  EXPECT_EQ(lines[4], "   DI      0  1  2  3  4  5  6  7");
}

TEST(FaceText, RelaysAreNumberedFromOne) {
  ModuleBench bench("EX9068AD-M");
  EXPECT_EQ(shown(bench)[1], "   RL      1  2  3  4  5  6  7  8");
}

/// Expects that no line of the face has more than 80 characters.
void expect_to_fit(ModuleBench& bench) {
  for (const std::string& line : face_text(999, bench.module(), bench.now(), kPlainLamps)) {
    EXPECT_LE(line.size(), 80U) << line;
  }
}

TEST(FaceText, FitsIn80ColumnsInEachProtocolInInitModeAndWithoutPower) {
  for (const Model& model : kModels) {
    std::vector<std::string> settings{"baud=115200,checksum=on"};
    if (model.speaks_modbus()) {
      settings = {"baud=115200,protocol=modbus", "baud=115200,protocol=ascii,checksum=on"};
    }
    for (const std::string& each : settings) {
      ModuleBench bench(std::string(model.designation) + "," + each);
      expect_to_fit(bench);
      bench.module().set_init(true);
      bench.module().reset();
      bench.run(std::chrono::milliseconds(100));
      expect_to_fit(bench);
      bench.module().power(false);
      expect_to_fit(bench);
    }
  }
}

TEST(FaceText, FitsIn80ColumnsWithFiveDigitCountersOfEightInputs) {
  ModuleBench bench("EX9052D");
  for (unsigned input = 0; input < 8; ++input) {
    bench.module().pulse_input(input, 0xFFFF);
  }
  const Lines lines = shown(bench);
  EXPECT_TRUE(std::any_of(lines.begin(), lines.end(), [](const std::string& line) {
    return line.find("65535 65535") != std::string::npos;
  }));
  expect_to_fit(bench);
}

TEST(FaceText, ShowsOutputsAsRoundLampsIfRequested) {
  ModuleBench bench("EX9060D");
  ASSERT_EQ(bench.ask("@011"), ">");
  EXPECT_EQ(shown(bench, kRoundLamps)[2], "           ●  ○  ○  ○");
}

TEST(FaceText, WithoutPowerShowsNoActiveSettingsCountersLatchesOrHostWatchdog) {
  ModuleBench bench("EX9052D@07");
  bench.module().set_input(0, true);
  bench.module().set_init(true);
  bench.module().power(false);
  EXPECT_EQ(shown(bench),
            (Lines{
                "1  EX9052D     9052                              LED - off      power off, INIT*",
                "   DI      0  1  2  3  4  5  6  7",
                "           *  -  -  -  -  -  -  -",
            }));
  bench.module().power(true);
  bench.module().interrupt_supply(true);
  EXPECT_NE(shown(bench)[0].find("no power"), std::string::npos);
}

/// After the timeout of 2.0 s the outputs go to their safe values, and the LED flashes twice a second.
TEST(FaceText, ShowsTheHostWatchdogsCountdownAndThenTheFlashingLed) {
  ModuleBench bench("EX9042D");
  ASSERT_EQ(bench.ask("@010001"), ">");
  ASSERT_EQ(bench.ask("~015S"), "!01");  // stores the present value as the safe value
  ASSERT_EQ(bench.ask("@010000"), ">");
  ASSERT_EQ(bench.ask("~013114"), "!01");
  bench.send("~**\r");
  bench.run(milliseconds(450));
  EXPECT_EQ(shown(bench).back(), "   host watchdog 2.0 s, 1.5 s left");
  bench.run(milliseconds(2000));
  EXPECT_EQ(shown(bench).back(), "   host watchdog timed out");
  EXPECT_EQ(shown(bench)[2], "           *  -  -  -  -  -  -  -  -  -  -  -  -");
  unsigned lit = 0;
  for (int i = 0; i < 40; ++i) {
    bench.run(milliseconds(25));
    const std::string head = shown(bench)[0];
    EXPECT_NE(head.find(" flashing "), std::string::npos);
    lit += head.find("LED * ") != std::string::npos ? 1 : 0;
  }
  EXPECT_EQ(lit, 20U);
}

TEST(FaceChanges, ListsEverythingIfThereIsNoPreviousFace) {
  ModuleBench bench("EX9055D@0A");
  const Face face = face_of(bench.module(), bench.now());
  EXPECT_EQ(changes_text(bench.module().model(), nullptr, face),
            (Lines{"power on", "INIT* off", "0A DCON 9600 8N1", "LED on", "outputs 0000",
                   "power-on 0000, safe 0000", "inputs 00", "counters 0 0 0 0 0 0 0 0",
                   "latched high 00, low 00", "host watchdog off"}));
}

TEST(FaceChanges, ListsNothingIfNothingHasChanged) {
  ModuleBench bench("EX9055D");
  const Face before = face_of(bench.module(), bench.now());
  bench.run(std::chrono::seconds(10));
  EXPECT_EQ(changes_text(bench.module().model(), &before, face_of(bench.module(), bench.now())), Lines{});
}

TEST(FaceChanges, ListsOnlyTheChanges) {
  ModuleBench bench("EX9055D");
  const Face before = face_of(bench.module(), bench.now());
  ASSERT_EQ(bench.ask("@0181"), ">");
  bench.module().set_input(4, true);
  EXPECT_EQ(changes_text(bench.module().model(), &before, face_of(bench.module(), bench.now())),
            (Lines{"outputs 0081", "inputs 10", "latched high 10, low 00"}));
  bench.module().power(false);
  EXPECT_EQ(changes_text(bench.module().model(), &before, face_of(bench.module(), bench.now())),
            (Lines{"power off", "LED off", "inputs 10"}));
}

}  // namespace
}  // namespace ex9000::sim
