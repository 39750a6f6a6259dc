// Power cuts: each power-on is a new emulator, and nothing but the EEPROM's file is left of the one before.
#include <gtest/gtest.h>

#include <chrono>
#include <cstdio>
#include <random>
#include <string>
#include <thread>

#include "tests/rig/master.hpp"

namespace ex9000::rig {
namespace {

TEST(ImageWithoutPower, KeepsItsSettings) {
  const Model& model = *find_model("EX9042D-M");
  const Settings settings = ascii(model);
  EmulatedModule module(model, &settings);
  module.power(true);
  wait_until_up(module);
  EXPECT_EQ(ask(module, "~01OPUMP 7"), "!01");
  EXPECT_EQ(ask(module, "%0102400600"), "!02");
  EXPECT_EQ(ask(module, "@021234"), ">");
  EXPECT_EQ(ask(module, "~025P"), "!02");
  module.power(false);
  EXPECT_EQ(module.outputs(), 0);
  module.power(true);
  wait_until_up(module);
  EXPECT_EQ(ask(module, "$02M"), "!02PUMP 7");
  EXPECT_EQ(ask(module, "@02"), ">1234");
  EXPECT_EQ(module.outputs(), 0x1234);
  EXPECT_EQ(ask(module, "$025"), "!021");
}

/// The seed says when.
class PowerCut : public testing::TestWithParam<unsigned> {};

TEST_P(PowerCut, WhileSettingsAreWrittenLeavesTheOldOnesOrTheNew) {
  constexpr unsigned kCuts = 12;
  constexpr unsigned kLatest = 4000;  // us; the write takes less
  std::mt19937 random(GetParam());
  const Model& model = *find_model("EX9042D-M");
  const Settings settings = ascii(model);
  EmulatedModule module(model, &settings);
  module.power(true);
  wait_until_up(module);
  std::string name = "OLD";
  ASSERT_EQ(ask(module, "~01O" + name), "!01");
  unsigned kept = 0;
  for (unsigned cut = 0; cut < kCuts; ++cut) {
    const std::string changed = "NEW" + std::to_string(cut);
    const std::string command = "~01O" + changed + "\r";
    module.send({command.begin(), command.end()});
    std::this_thread::sleep_for(
        std::chrono::microseconds(std::uniform_int_distribution<unsigned>(0, kLatest)(random)));
    module.power(false);
    module.power(true);
    wait_until_up(module);
    const std::string found = ask(module, "$01M");
    ASSERT_TRUE(found == "!01" + name || found == "!01" + changed) << "cut " << cut << ": " << found;
    kept += found == "!01" + name ? 1U : 0U;
    name = found.substr(3);
  }
  std::printf("seed %u: %u cuts, the old settings %u times, the new ones %u times\n", GetParam(), kCuts, kept,
              kCuts - kept);
}

INSTANTIATE_TEST_SUITE_P(AtRandom, PowerCut, testing::Values(1U, 2U, 3U, 4U));

}  // namespace
}  // namespace ex9000::rig
