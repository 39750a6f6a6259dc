// Tests a module and its memory: stores, failed stores, power cuts, unreadable settings, and the frames that
// the module keeps during a store.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "tests/firmware/module_bench.hpp"

namespace ex9000::sim {
namespace {

using Bytes = ModuleBench::Bytes;
using std::chrono::microseconds;
using std::chrono::milliseconds;

// --- wire.md section 8: a valid reply to a command means that its settings are stored ---

TEST(Storing, ACommandThatCannotBeStoredIsRefusedAndChangesNothing) {
  const std::vector<std::string> commands{"%0102400680", "~01OABC", "~013164", "~015P", "~015S"};
  ModuleBench bench("EX9042D,name=OLD");
  ASSERT_EQ(bench.ask("@010007"), ">");
  const Settings before = bench.module().module().state().settings;
  bench.module().memory().fail(true);
  for (const std::string& command : commands) {
    EXPECT_EQ(bench.ask(command), "?01") << command;
    EXPECT_EQ(bench.module().module().outcome().refusal, Refusal::StoreFailed) << command;
    EXPECT_EQ(bench.module().module().state().settings, before) << command;
  }
  bench.module().memory().fail(false);
  bench.power_cycle();
  EXPECT_EQ(bench.module().module().state().settings, before);
  EXPECT_EQ(bench.ask("$01M"), "!01OLD");
}

TEST(Storing, AModbusRequestThatCannotBeStoredIsRefusedWithServerDeviceFailure) {
  ModuleBench bench("EX9042D-M");
  bench.module().memory().fail(true);
  EXPECT_EQ(bench.ask(Bytes{1, 0x06, 0x01, 0xE4, 0x00, 0x05}), (Bytes{1, 0x86, 4}));
  EXPECT_EQ(bench.ask(Bytes{1, 0x05, 0x00, 0x80, 0xFF, 0x00}), (Bytes{1, 0x85, 4}));
  EXPECT_EQ(bench.ask(Bytes{1, 0x0F, 0x00, 0xA0, 0x00, 0x0D, 0x02, 0xFF, 0x1F}), (Bytes{1, 0x8F, 4}));
  EXPECT_EQ(bench.ask(Bytes{1, 0x46, 0x04, 0x05, 0x00, 0x00, 0x00}), (Bytes{1, 0xC6, 4}));
  EXPECT_EQ(bench.module().outputs(), 0);  // the refused values drive no output
  EXPECT_EQ(bench.ask(Bytes{1, 0x08, 0x00, 0x0D, 0x00, 0x00}), (Bytes{1, 0x08, 0x00, 0x0D, 0x00, 0x04}));
}

TEST(Storing, ABroadcastThatCannotBeStoredGetsNoReplyAndHasNoEffect) {
  ModuleBench bench("EX9042D-M");
  bench.module().memory().fail(true);
  EXPECT_EQ(bench.ask(Bytes{0, 0x05, 0x00, 0x80, 0xFF, 0x00}), Bytes());
  EXPECT_EQ(bench.module().outputs(), 0);
}

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

TEST(Storing, ATimeoutStatusIsClearedOnceAndNotAgain) {
  ModuleBench ascii("EX9042D");
  ASSERT_EQ(ascii.ask("~013101"), "!01");  // the watchdog has expired when `ask` returns
  expect_nothing_written_the_second_time<std::string>(
      ascii, {"~011"}, [&ascii](const std::string& command) { return ascii.ask(command) == "!01"; });
  ModuleBench modbus("EX9042D-M");
  for (const std::uint8_t address : {std::uint8_t{1}, std::uint8_t{0}}) {
    modbus.ask(Bytes{1, 0x06, 0x01, 0xE8, 0x00, 0x01});
    modbus.ask(Bytes{1, 0x05, 0x01, 0x04, 0xFF, 0x00});
    ASSERT_TRUE(modbus.module().module().state().settings.timeout_status);
    expect_nothing_written_the_second_time<Bytes>(
        modbus, {{address, 0x05, 0x01, 0x0D, 0xFF, 0x00}},
        [&modbus](const Bytes& request) { return modbus.ask(request).empty() == (request[0] == 0); });
  }
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

TEST(Storing, AnUnchangedSafeBitIsNotStoredButStillDrivesItsOutput) {
  ModuleBench bench("EX9068D-M");
  bench.ask(Bytes{1, 0x05, 0x00, 0x80, 0xFF, 0x00});
  bench.ask(Bytes{1, 0x05, 0x00, 0x00, 0x00, 0x00});
  ASSERT_EQ(bench.module().outputs(), 0);
  const auto writes = bench.module().memory().writes();
  bench.ask(Bytes{1, 0x05, 0x00, 0x80, 0xFF, 0x00});
  EXPECT_EQ(bench.module().outputs(), 1);
  EXPECT_EQ(bench.module().memory().writes(), writes);
}

TEST(Storing, APowerFailureNeitherLeavesACommandHalfDoneNorLosesAnAcknowledgedCommand) {
  const std::vector<std::string> commands{"%0133400680", "~01OABCDEF", "~013164", "~015P", "~015S"};
  int cuts = 0;
  for (const std::string& command : commands) {
    for (const bool stored_before : {false, true}) {
      bool acknowledged = false;
      for (VirtualTime cut = microseconds(0); !acknowledged; cut += microseconds(100)) {
        ModuleBench bench(stored_before ? "EX9042D,name=OLD,edge=rising" : "EX9042D");
        if (stored_before) {
          ASSERT_EQ(bench.ask("~01OOLDER"), "!01");  // both copies are in use
        }
        ASSERT_EQ(bench.ask("@011FFF"), ">");
        const Settings before = bench.module().module().state().settings;
        bench.forget_heard();
        bench.send(command + "\r");
        bench.run(cut);
        acknowledged = !bench.heard_text().empty();
        bench.power_cycle();
        ++cuts;
        const Settings after = bench.module().module().state().settings;
        ASSERT_FALSE(bench.module().module().settings_unreadable() && acknowledged);

        ModuleBench undisturbed(stored_before ? "EX9042D,name=OLD,edge=rising" : "EX9042D");
        if (stored_before) {
          undisturbed.ask("~01OOLDER");
        }
        undisturbed.ask("@011FFF");
        undisturbed.ask(command);
        const Settings done = undisturbed.module().module().state().settings;
        ASSERT_TRUE(after == done || (!acknowledged && after == before))
            << command << " cut at " << cut.count() << " ns";
      }
    }
  }
  std::printf("power cuts of whole modules: %d\n", cuts);
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

TEST(Storing, RefusedSettingsAreNotInForceAfterTheNextResetEvenIfTheyWereWritten) {
  ModuleBench bench("EX9042D,name=OLD");
  bench.send("~01ONEW\r");
  bench.line().wires().run_until(bench.line().wires().next());     // the turn-around is over
  ASSERT_EQ(bench.module().memory().writes(), 1U);                 // the write has begun
  bench.line().wires().run_until(bench.module().memory().next());  // written, but not yet read back
  bench.module().memory().fail(true);
  bench.forget_heard();
  bench.run(milliseconds(200));
  EXPECT_EQ(bench.heard_text(), "?01\r");
  bench.module().memory().fail(false);
  bench.run(milliseconds(1500));
  bench.power_cycle();
  EXPECT_EQ(bench.ask("$01M"), "!01OLD");
}

TEST(Storing, AStoringCommandIsRefusedWhileAnEarlierTimeoutCannotBeStored) {
  // The timeout has disabled the watchdog, but the module has not stored this change yet. As long as the
  // memory cannot store the change, the module must refuse the command that disables the watchdog.
  ModuleBench bench("EX9042D");
  ASSERT_EQ(bench.ask("~013103"), "!01");
  bench.module().memory().fail(true);
  bench.run(milliseconds(500));
  ASSERT_EQ(bench.ask("~012"), "!01003");
  EXPECT_EQ(bench.ask("~013003"), "?01");
  bench.module().memory().fail(false);
  EXPECT_EQ(bench.ask("~013003"), "!01");
  bench.power_cycle();
  EXPECT_EQ(bench.ask("~012"), "!01003");
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

// --- wire.md section 8: while a command is executed or stored, the module keeps at least one more frame ---

TEST(Queueing, WhileACommandIsStoredOnlyTheFirstOfTwoFramesIsKept) {
  ModuleBench bench("EX9042D,baud=115200");
  bench.forget_heard();
  bench.send("~01ONEW\r$01M\r$012\r");
  bench.run(milliseconds(200));
  EXPECT_EQ(bench.heard_text(), "!01\r!01NEW\r");
}

TEST(Queueing, AHostOkIsNotLostWhileTheQueueIsFull) {
  ModuleBench bench("EX9042D,baud=115200");
  ASSERT_EQ(bench.ask("~013105"), "!01");
  bench.run(milliseconds(200));  // together with the wait in `ask`, about 450 ms of the 500 ms are over
  bench.send("~01ONEW\r$01M\r~**\r");
  bench.run(milliseconds(300));
  EXPECT_FALSE(bench.module().module().state().settings.timeout_status);
}

TEST(Queueing, ACompleteModbusFrameIsNotLostWhenThePreviousReplyStarts) {
  // The host OK is complete, except for its silence, when the module switches its driver on.
  ModuleBench bench("EX9068D-M");
  bench.ask(Bytes{1, 0x06, 0x01, 0xE8, 0x00, 0x05});
  bench.ask(Bytes{1, 0x05, 0x01, 0x04, 0xFF, 0x00});
  bench.run(milliseconds(150));
  bench.send(with_crc({1, 0x05, 0x00, 0xA0, 0xFF, 0x00}));
  bench.run(microseconds(4100));
  bench.send(with_crc({1, 0x03, 0x30, 0x38, 0x00, 0x00}));
  const VirtualTime sent = bench.now();
  bench.recorder().clear();
  bench.run(milliseconds(400));
  ASSERT_FALSE(bench.recorder().drivers.empty());
  // The driver must be switched on before the silence ends. Otherwise the test proves nothing.
  EXPECT_LT(bench.recorder().drivers[0].at, sent + microseconds(4010));
  EXPECT_FALSE(bench.module().module().state().settings.timeout_status);
}

TEST(Queueing, TwoRepliesAreAtLeastT35Apart) {
  ModuleBench bench("EX9068D-M,baud=115200");
  bench.send(with_crc({1, 0x05, 0x00, 0xA0, 0xFF, 0x00}));
  bench.run(microseconds(1800));
  bench.send(with_crc({1, 0x01, 0x00, 0x00, 0x00, 0x08}));
  bench.run(milliseconds(100));
  std::vector<WiresRecorder::Driver> on;
  std::vector<WiresRecorder::Driver> off;
  for (const auto& driver : bench.recorder().drivers) {
    if (driver.station == 1) {
      (driver.on ? on : off).push_back(driver);
    }
  }
  ASSERT_EQ(on.size(), 2U);
  EXPECT_GE(on[1].at - off[0].at, microseconds(1750));
}

// wire.md section 8: a valid reply means that the settings are stored. Settings that could not be read may be
// readable again after the next reset, so the module must store even the factory values.
TEST(Storing, ACommandWithFactoryValuesIsStoredIfTheSettingsWereUnreadable) {
  ModuleBench bench("EX9042D");
  ASSERT_EQ(bench.ask("~01OONE"), "!01");
  bench.module().memory().fail(true);
  bench.power_cycle();
  ASSERT_EQ(bench.ask("$01M"), "!019042D");
  bench.module().memory().fail(false);
  ASSERT_EQ(bench.ask("~01O9042D"), "!01");
  bench.power_cycle();
  EXPECT_EQ(bench.ask("$01M"), "!019042D");
}

}  // namespace
}  // namespace ex9000::sim
