// Tests what a module writes to its memory, and what it does with unreadable settings.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/firmware/module_bench.hpp"

namespace ex9000::sim {
namespace {

using Bytes = ModuleBench::Bytes;
using std::chrono::milliseconds;

// --- wire.md section 8: a valid reply to a command means that its settings are stored ---

/// Sends each command twice. The first execution may store something, but the second execution must not. More
/// than half of the commands must store something the first time. `ask` sends a command and returns whether
/// the reply, or its absence, is as expected.
template <class Command, class Ask>
void expect_nothing_written_the_second_time(ModuleBench& bench, const std::vector<Command>& commands,
                                            Ask ask) {
  unsigned stored = 0;
  for (const Command& command : commands) {
    SCOPED_TRACE(testing::PrintToString(command));
    const auto before = bench.module().memory().writes();
    EXPECT_TRUE(ask(command));
    const auto writes = bench.module().memory().writes();
    EXPECT_TRUE(ask(command));
    EXPECT_EQ(bench.module().memory().writes(), writes);
    stored += writes != before ? 1U : 0U;
  }
  EXPECT_GT(stored, commands.size() / 2) << "too few commands stored something, so this test proves nothing";
}

TEST(Storing, ABroadcastThatCannotBeStoredGetsNoReplyAndHasNoEffect) {
  ModuleBench bench("EX9042D-M");
  bench.module().memory().fail(true);
  EXPECT_EQ(bench.ask(Bytes{0, 0x05, 0x00, 0x80, 0xFF, 0x00}), Bytes());
  EXPECT_EQ(bench.module().outputs(), 0);
}

// extensions.md, scan: an exception, too, has the prefix.
TEST(Storing, ARequestBySerialNumberThatCannotBeStoredGetsAnExceptionWithTheNumber) {
  ModuleBench bench("EX9042D-M");
  bench.ask(Bytes{0x01, 0x10, 0x01, 0x0E, 0x00, 0x02, 0x04, 0x0D, 0x00, 0x12, 0x34});
  bench.module().memory().fail(true);
  EXPECT_EQ(bench.ask(Bytes{0xFD, 0x46, 0x08, 0x0D, 0x00, 0x12, 0x34, 0x06, 0x01, 0xE8, 0x00, 0x05}),
            (Bytes{0xFD, 0x46, 0x09, 0x0D, 0x00, 0x12, 0x34, 0x86, 0x04}));
}

TEST(Storing, ACommandThatChangesNothingWritesNothing) {
  // The outputs differ from the stored values, so that `~AA5P` and `~AA5S` have a value to store.
  ModuleBench ascii("EX9042D-M,protocol=ascii");
  ascii.ask("@010005");
  const std::vector<std::string> commands{"%0101400680", "~01OABC", "~0131FE", "~01OABCD",
                                          "~0130FE",     "~011",    "~015P",   "~015S"};
  const auto done = [](ModuleBench& bench) {
    return [&bench](const std::string& command) { return bench.ask(command).at(0) == '!'; };
  };
  expect_nothing_written_the_second_time(ascii, commands, done(ascii));
  ascii.module().set_init(true);
  ascii.run(milliseconds(15));
  expect_nothing_written_the_second_time<std::string>(ascii, {"$01P1", "%01014007C0", "$01P0"}, done(ascii));
}

TEST(Storing, ACommandThatChangesNothingWritesNothingInInitModeEither) {
  ModuleBench bench("EX9042D-M,init=on");
  bench.ask("@000005");
  expect_nothing_written_the_second_time<std::string>(
      bench, {"%00224007C0", "$00P0", "$00P1", "~00OABC", "~0031FE", "~0030FE", "~001", "~005P", "~005S"},
      [&bench](const std::string& command) { return bench.ask(command).at(0) == '!'; });
}

TEST(Storing, ARequestThatChangesNothingWritesNothing) {
  ModuleBench bench("EX9042D-M");
  const std::vector<Bytes> requests{
      {1, 0x06, 0x01, 0xE4, 0x00, 0x07},
      {1, 0x06, 0x01, 0xE5, 0x00, 0x0A},
      {1, 0x06, 0x01, 0xE8, 0x00, 0x64},
      {1, 0x10, 0x01, 0xE8, 0x00, 0x01, 0x02, 0x00, 0x65},
      {1, 0x10, 0x01, 0xE4, 0x00, 0x02, 0x04, 0x00, 0x08, 0x00, 0x09},
      {1, 0x05, 0x01, 0x04, 0xFF, 0x00},
      {1, 0x05, 0x01, 0x04, 0x00, 0x00},
      {1, 0x05, 0x00, 0x80, 0xFF, 0x00},
      {1, 0x05, 0x00, 0xA3, 0xFF, 0x00},
      {1, 0x0F, 0x00, 0x80, 0x00, 0x0D, 0x02, 0x5A, 0x0A},
      {1, 0x0F, 0x00, 0xA0, 0x00, 0x0D, 0x02, 0xA5, 0x05},
      {1, 0x0F, 0x00, 0xA4, 0x00, 0x04, 0x01, 0x05},
      {1, 0x05, 0x01, 0x00, 0x00, 0x00},
      {1, 0x05, 0x01, 0x0D, 0xFF, 0x00},
      {1, 0x46, 0x04, 0x09, 0x00, 0x00, 0x00},
  };
  expect_nothing_written_the_second_time(
      bench, requests, [&bench](const Bytes& request) { return bench.ask(request).at(1) == request[1]; });
}

TEST(Storing, ABroadcastThatChangesNothingWritesNothing) {
  ModuleBench bench("EX9042D-M");
  const std::vector<Bytes> broadcasts{
      {0, 0x06, 0x01, 0xE8, 0x00, 0x64},
      {0, 0x10, 0x01, 0xE8, 0x00, 0x01, 0x02, 0x00, 0x65},
      {0, 0x05, 0x01, 0x04, 0xFF, 0x00},
      {0, 0x05, 0x01, 0x04, 0x00, 0x00},
      {0, 0x05, 0x00, 0x80, 0xFF, 0x00},
      {0, 0x05, 0x00, 0xA3, 0xFF, 0x00},
      {0, 0x0F, 0x00, 0x80, 0x00, 0x0D, 0x02, 0x5A, 0x0A},
      {0, 0x0F, 0x00, 0xA0, 0x00, 0x0D, 0x02, 0xA5, 0x05},
      {0, 0x05, 0x01, 0x0D, 0xFF, 0x00},
  };
  expect_nothing_written_the_second_time(
      bench, broadcasts, [&bench](const Bytes& broadcast) { return bench.ask(broadcast).empty(); });
}

TEST(Storing, CommandsThatReadOrDriveOutputsAndRefusedCommandsWriteNothing) {
  ModuleBench bench("EX9055D");
  for (const char* command :
       {"$012", "$016", "@01", "#010", "~010", "~012", "~014P", "$01F", "$01M", "$015", "~01O", "~013000",
        "%0101410600", "@01FFF", "~015X", "$01P1", "@01FF", "#0100AA"}) {
    bench.ask(command);
  }
  EXPECT_EQ(bench.module().memory().writes(), 0U);
}

TEST(Storing, UnreadableSettingsCauseFactorySettingsAndALedPatternButNoWrite) {
  ModuleBench bench("EX9042D,name=OLD");
  for (const bool no_answer : {false, true}) {
    bench.module().power(false);
    std::fill(bench.module().memory().contents().begin(), bench.module().memory().contents().end(),
              std::uint8_t{0x5A});
    bench.module().memory().fail(no_answer);
    const auto writes = bench.module().memory().writes();
    bench.module().power(true);
    bench.run(milliseconds(100));
    EXPECT_EQ(bench.ask("$01M"), "!019042D");
    EXPECT_EQ(bench.module().module().led_pattern(), StatusLed::Pattern::SettingsUnreadable);
    EXPECT_EQ(bench.module().memory().writes(), writes);
  }
  bench.module().memory().fail(false);
  EXPECT_EQ(bench.ask("~01ONEW"), "!01");
  EXPECT_EQ(bench.module().module().led_pattern(), StatusLed::Pattern::Steady);
  bench.power_cycle();
  EXPECT_EQ(bench.ask("$01M"), "!01NEW");
}

TEST(Storing, AStoreIsPermanentEvenIfTheMemoryDidNotAnswerAtReset) {
  // The number of stores decides whether the newer copy is in the first or in the second place.
  for (const int stores : {3, 4}) {
    ModuleBench bench("EX9042D,name=OLD");
    for (int i = 0; i < stores; ++i) {
      ASSERT_EQ(bench.ask("~01OOLD" + std::to_string(i)), "!01");
    }
    bench.module().memory().fail(true);
    bench.power_cycle();
    ASSERT_TRUE(bench.module().module().settings_unreadable());
    EXPECT_EQ(bench.ask("~01ONEW"), "?01");
    bench.module().memory().fail(false);
    EXPECT_EQ(bench.ask("~01ONEW"), "!01");
    bench.power_cycle();
    EXPECT_EQ(bench.ask("$01M"), "!01NEW");
  }
}

TEST(Storing, SettingsOfAnotherModelAreNotUsed) {
  ModuleBench bench("EX9043D");
  ModuleBench other("EX9042D");
  ASSERT_EQ(other.ask("@011FFF"), ">");
  ASSERT_EQ(other.ask("~015P"), "!01");
  bench.module().power(false);
  bench.module().memory().contents() = other.module().memory().contents();
  bench.module().power(true);
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.module().outputs(), 0);
  EXPECT_TRUE(bench.module().module().settings_unreadable());
}

}  // namespace
}  // namespace ex9000::sim
