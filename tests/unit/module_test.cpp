// The whole module on its doubles: what a transcript cannot bring about or cannot see.
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "tests/unit/module_bench.hpp"

namespace ex9000::sim {
namespace {

using Bytes = ModuleBench::Bytes;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

struct OutputChange {
  VirtualTime at;
  std::uint16_t channels;
};

void watch_outputs(ModuleBench& bench, std::vector<OutputChange>& changes) {
  bench.module().output_pins().on_change([&](std::uint16_t channels) {
    changes.push_back({bench.now(), channels});
  });
}

// --- wire.md 8: a reply means it is stored ---

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
  EXPECT_EQ(bench.module().outputs(), 0);  // the outputs follow only what is stored
  EXPECT_EQ(bench.ask(Bytes{1, 0x08, 0x00, 0x0D, 0x00, 0x00}), (Bytes{1, 0x08, 0x00, 0x0D, 0x00, 0x04}));
}

TEST(Storing, ABroadcastThatCannotBeStoredStaysSilent) {
  ModuleBench bench("EX9042D-M");
  bench.module().memory().fail(true);
  EXPECT_EQ(bench.ask(Bytes{0, 0x05, 0x00, 0x80, 0xFF, 0x00}), Bytes());
  EXPECT_EQ(bench.module().outputs(), 0);
}

TEST(Storing, ACommandThatChangesNothingWritesNothing) {
  ModuleBench ascii("EX9042D");
  const std::vector<std::string> commands{"%0101400680", "~01OABC", "~013105", "~01OABC",
                                          "~013005",     "~011",    "~015P",   "~015S"};
  for (const std::string& command : commands) {
    ascii.ask(command);
    const auto writes = ascii.module().memory().writes();
    EXPECT_NE(ascii.ask(command), "?01") << command;
    EXPECT_EQ(ascii.module().memory().writes(), writes) << command;
    ascii.ask("~013005");
  }
  ModuleBench modbus("EX9042D-M");
  const std::vector<Bytes> frames{{1, 0x06, 0x01, 0xE4, 0x00, 0x07}, {1, 0x06, 0x01, 0xE5, 0x00, 0x0A},
                                  {1, 0x06, 0x01, 0xE8, 0x00, 0x64}, {1, 0x05, 0x00, 0x80, 0xFF, 0x00},
                                  {1, 0x05, 0x00, 0xA3, 0xFF, 0x00}, {1, 0x05, 0x01, 0x00, 0x00, 0x00},
                                  {1, 0x05, 0x01, 0x0D, 0xFF, 0x00}, {1, 0x46, 0x04, 0x09, 0x00, 0x00, 0x00}};
  for (const Bytes& frame : frames) {
    modbus.ask(frame);
    const auto writes = modbus.module().memory().writes();
    EXPECT_EQ(modbus.ask(frame).at(1), frame[1]);
    EXPECT_EQ(modbus.module().memory().writes(), writes);
  }
}

TEST(Storing, ReadingAndRefusedCommandsWriteNothing) {
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

TEST(Storing, WhereverThePowerFailsACommandIsWhollyDoneOrNotAtAllAndAnAcknowledgedOneIsDone) {
  const std::vector<std::string> commands{"%0133400680", "~01OABCDEF", "~013164", "~015P", "~015S"};
  int cuts = 0;
  for (const std::string& command : commands) {
    for (const bool stored_before : {false, true}) {
      bool acknowledged = false;
      for (VirtualTime cut = microseconds(0); !acknowledged; cut += microseconds(100)) {
        ModuleBench bench(stored_before ? "EX9042D,name=OLD,edge=rising" : "EX9042D");
        if (stored_before) {
          ASSERT_EQ(bench.ask("~01OOLDER"), "!01");  // both copies hold something
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
  std::printf("power cuts: %d\n", cuts);
}

TEST(Storing, SettingsThatCannotBeReadGiveFactorySettingsUnwrittenWithin100msAndAPatternOfTheirOwn) {
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

TEST(Storing, WhatIsStoredAfterAMemoryThatDidNotAnswerAtResetIsThereAtTheNext) {
  ModuleBench bench("EX9042D,name=OLD");
  for (const char* name : {"OLD1", "OLD2", "OLD3"}) {
    ASSERT_EQ(bench.ask(std::string("~01O") + name), "!01");
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

TEST(Storing, ARefusedStoreIsNotInForceAfterTheNextResetThoughItsWriteHadLanded) {
  ModuleBench bench("EX9042D,name=OLD");
  bench.send("~01ONEW\r");
  ASSERT_EQ(bench.module().memory().writes(), 1U);               // begun
  bench.line().bus().run_until(bench.module().memory().next());  // written; now it is to be read back
  bench.module().memory().fail(true);
  bench.forget_heard();
  bench.run(milliseconds(200));
  EXPECT_EQ(bench.heard_text(), "?01\r");
  bench.module().memory().fail(false);
  bench.run(milliseconds(1500));
  bench.power_cycle();
  EXPECT_EQ(bench.ask("$01M"), "!01OLD");
}

TEST(Storing, AReplyWaitsForATimeoutThatIsNotStoredYet) {
  // The timeout has switched the watchdog off, but the memory does not know: "off" is not stored before it
  // does.
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

TEST(Storing, AnotherModelsSettingsDoNotCount) {
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

// --- wire.md 8: while one command is executed or stored, one more frame is kept ---

TEST(Queueing, OfTwoFramesBehindAStoringOneTheFirstIsKept) {
  ModuleBench bench("EX9042D,baud=115200");
  bench.forget_heard();
  bench.send("~01ONEW\r$01M\r$012\r");
  bench.run(milliseconds(200));
  EXPECT_EQ(bench.heard_text(), "!01\r!01NEW\r");
}

TEST(Queueing, AHostOkBehindAFullQueueIsNotLost) {
  ModuleBench bench("EX9042D,baud=115200");
  ASSERT_EQ(bench.ask("~013105"), "!01");
  bench.run(milliseconds(200));  // 450 ms of the 500 are over with what `ask` waited
  bench.send("~01ONEW\r$01M\r~**\r");
  bench.run(milliseconds(300));
  EXPECT_FALSE(bench.module().module().state().settings.timeout_status);
}

TEST(Queueing, AWholeModbusFrameSurvivesTheReplyToTheOneBeforeIt) {
  // The host OK is over, but for its silence, when the driver comes on.
  ModuleBench bench("EX9068D-M");
  bench.ask(Bytes{1, 0x06, 0x01, 0xE8, 0x00, 0x05});
  bench.ask(Bytes{1, 0x05, 0x01, 0x04, 0xFF, 0x00});
  bench.run(milliseconds(150));
  bench.send(ModuleBench::with_crc({1, 0x05, 0x00, 0xA0, 0xFF, 0x00}));
  bench.run(microseconds(4100));
  bench.send(ModuleBench::with_crc({1, 0x03, 0x30, 0x38, 0x00, 0x00}));
  const VirtualTime sent = bench.now();
  bench.recorder().clear();
  bench.run(milliseconds(400));
  ASSERT_FALSE(bench.recorder().drivers.empty());
  EXPECT_LT(bench.recorder().drivers[0].at, sent + microseconds(4010));  // else this shows nothing
  EXPECT_FALSE(bench.module().module().state().settings.timeout_status);
}

TEST(Queueing, TwoRepliesAreNeverOneFrameToTheMaster) {
  ModuleBench bench("EX9068D-M,baud=115200");
  bench.send(ModuleBench::with_crc({1, 0x05, 0x00, 0xA0, 0xFF, 0x00}));
  bench.run(microseconds(1800));
  bench.send(ModuleBench::with_crc({1, 0x01, 0x00, 0x00, 0x00, 0x08}));
  bench.run(milliseconds(100));
  std::vector<BusRecorder::Driver> on;
  std::vector<BusRecorder::Driver> off;
  for (const auto& driver : bench.recorder().drivers) {
    if (driver.station == 1) {
      (driver.on ? on : off).push_back(driver);
    }
  }
  ASSERT_EQ(on.size(), 2U);
  EXPECT_GE(on[1].at - off[0].at, microseconds(1750));
}

// --- wire.md 6: host watchdog ---

TEST(HostWatchdog, HostOksCloserThanTheTimeoutKeepItFromExpiringAtAnyRate) {
  for (const std::uint32_t baud : kBaudRates) {
    ModuleBench bench("EX9068D-M,baud=" + std::to_string(baud));
    const Bytes host_ok = ModuleBench::with_crc({1, 0x03, 0x30, 0x38, 0x00, 0x00});
    bench.ask(Bytes{1, 0x06, 0x01, 0xE8, 0x00, 0x03});
    bench.send(ModuleBench::with_crc({1, 0x05, 0x01, 0x04, 0xFF, 0x00}));
    bench.run(milliseconds(150));
    for (int i = 0; i < 20; ++i) {
      const VirtualTime began = bench.now();
      bench.send(host_ok);
      bench.line().bus().run_until(began + milliseconds(299));
    }
    EXPECT_FALSE(bench.module().module().state().settings.timeout_status) << baud;
  }
}

TEST(HostWatchdog, ATimeoutBehindAClearingThatIsBeingStoredIsNotClearedByIt) {
  ModuleBench bench("EX9043D,baud=115200");
  ASSERT_EQ(bench.ask("~013101"), "!01");  // has expired by now
  bench.send("~013101\r");                 // armed again
  bench.run(milliseconds(15));
  while (bench.module().module().state().settings.watchdog_enabled == false) {
    bench.run(milliseconds(1));
  }
  bench.run(milliseconds(86));
  bench.forget_heard();
  bench.send("~011\r");
  bench.run(milliseconds(50));
  EXPECT_EQ(bench.heard_text(), "!01\r");
  EXPECT_EQ(bench.ask("~010"), "!0104");
  bench.power_cycle();
  EXPECT_EQ(bench.ask("~010"), "!0104");
}

TEST(HostWatchdog, RunsThoughTheInitSwitchNeverStandsStill) {
  ModuleBench bench("EX9043D");
  ASSERT_EQ(bench.ask("@010001"), ">");
  ASSERT_EQ(bench.ask("~015P"), "!01");
  ASSERT_EQ(bench.ask("~013104"), "!01");
  bench.module().reset();
  for (int i = 0; i < 200; ++i) {
    bench.module().set_init(i % 2 == 0);
    bench.run(milliseconds(3));
  }
  EXPECT_EQ(bench.module().outputs(), 0);
  EXPECT_EQ(bench.ask("~010"), "!0104");  // and it has come up, with INIT* taken for released
}

TEST(HostWatchdog, ExpiresAfterEveryTimeoutNeverEarlyAndAtMostAMillisecondLate) {
  for (unsigned timeout = 1; timeout <= 255; ++timeout) {
    ModuleBench bench("EX9043D");
    ASSERT_EQ(bench.ask("@010001"), ">");
    bench.send("~0131" + hex_byte_text(timeout) + "\r");
    bench.run(milliseconds(50));
    std::vector<OutputChange> changes;
    watch_outputs(bench, changes);
    bench.send("~**\r");
    const VirtualTime restarted = bench.now();
    bench.run(milliseconds(100) * timeout + seconds(1));
    ASSERT_EQ(changes.size(), 1U) << timeout;
    EXPECT_GE(changes[0].at, restarted + milliseconds(100) * timeout) << timeout;
    EXPECT_LE(changes[0].at, restarted + milliseconds(100) * timeout + milliseconds(1)) << timeout;
  }
}

TEST(HostWatchdog, EnablingStartsItWhenItIsStored) {
  ModuleBench bench("EX9043D");
  ASSERT_EQ(bench.ask("@010001"), ">");
  std::vector<OutputChange> changes;
  watch_outputs(bench, changes);
  bench.recorder().clear();
  bench.ask("~013101");
  ASSERT_EQ(changes.size(), 1U);
  // That is between the request's end and the reply's start.
  const VirtualTime request_end = bench.recorder().bytes[7].end;
  const VirtualTime reply_start = bench.recorder().bytes[8].start;
  EXPECT_GE(changes[0].at, request_end + milliseconds(100));
  EXPECT_LE(changes[0].at, reply_start + milliseconds(100));
}

TEST(HostWatchdog, ExpiryDrivesTheSafeValueAtOnceEvenWhileACommandIsBeingStored) {
  ModuleBench bench("EX9043D-M,baud=115200");
  bench.ask(Bytes{1, 0x06, 0x01, 0xE8, 0x00, 0x05});
  bench.ask(Bytes{1, 0x0F, 0x00, 0x00, 0x00, 0x10, 0x02, 0x0F, 0x00});
  bench.ask(Bytes{1, 0x05, 0x01, 0x04, 0xFF, 0x00});
  bench.send(ModuleBench::with_crc({1, 0x03, 0x30, 0x38, 0x00, 0x00}));
  const VirtualTime restarted = bench.now() + microseconds(1750);  // the silence that ends the frame
  std::vector<OutputChange> changes;
  watch_outputs(bench, changes);
  // Storing the power-on value takes some 10 ms and would drive all outputs; the timeout falls into it.
  bench.run(milliseconds(493));
  bench.forget_heard();
  bench.send(ModuleBench::with_crc({1, 0x0F, 0x00, 0xA0, 0x00, 0x10, 0x02, 0xFF, 0xFF}));
  bench.run(milliseconds(250));
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_EQ(changes[0].channels, 0);
  EXPECT_GE(changes[0].at, restarted + milliseconds(500));
  EXPECT_LE(changes[0].at, restarted + milliseconds(501));
  EXPECT_FALSE(bench.heard_text().empty());  // stored and answered all the same (D6)
  EXPECT_EQ(bench.module().module().state().settings.power_on_value, 0xFFFF);
  bench.power_cycle();
  EXPECT_TRUE(bench.module().module().state().settings.timeout_status);
  EXPECT_EQ(bench.module().outputs(), 0);
}

TEST(HostWatchdog, ATimeoutThatCannotBeStoredHoldsAllTheSameAndIsStoredLater) {
  ModuleBench bench("EX9043D");
  ASSERT_EQ(bench.ask("@0100FF"), ">");
  ASSERT_EQ(bench.ask("~013105"), "!01");
  bench.module().memory().fail(true);
  bench.run(milliseconds(600));
  EXPECT_EQ(bench.module().outputs(), 0);
  EXPECT_EQ(bench.ask("~010"), "!0104");
  EXPECT_EQ(bench.ask("~012"), "!01005");
  EXPECT_EQ(bench.ask("@0100FF"), "!");
  bench.module().memory().fail(false);
  bench.run(milliseconds(1500));
  bench.power_cycle();
  EXPECT_EQ(bench.ask("~010"), "!0104");
  EXPECT_EQ(bench.ask("~012"), "!01005");
}

TEST(HostWatchdog, ClearingTheStatusWhileItsStoreIsUnderWayIsStoredBehindIt) {
  ModuleBench bench("EX9043D,baud=115200");
  ASSERT_EQ(bench.ask("~013103"), "!01");
  while (!bench.module().module().state().settings.timeout_status) {
    bench.run(milliseconds(1));
  }
  EXPECT_EQ(bench.ask("~011"), "!01");
  bench.power_cycle();
  EXPECT_EQ(bench.ask("~010"), "!0100");
}

TEST(HostWatchdog, TheLedFlashesAtTwoHertzOnItsPin) {
  ModuleBench bench("EX9043D");
  ASSERT_EQ(bench.ask("~013101"), "!01");
  bench.run(seconds(1));
  std::vector<VirtualTime> changes;
  bench.module().led().on_change([&](bool /*lit*/) { changes.push_back(bench.now()); });
  bench.run(seconds(10));
  ASSERT_EQ(changes.size(), 40U);
  for (std::size_t i = 1; i < changes.size(); ++i) {
    EXPECT_NEAR(static_cast<double>((changes[i] - changes[i - 1]).count()), 250e6, 2e3);
  }
  ASSERT_EQ(bench.ask("~011"), "!01");
  changes.clear();
  bench.run(seconds(2));
  EXPECT_TRUE(changes.empty());
  EXPECT_TRUE(bench.module().led_lit());
}

// --- wire.md 6: module watchdog ---

TEST(ModuleWatchdog, AHungMainLoopIsResetWithin1600msAndSaysSo) {
  ModuleBench bench("EX9068D-M,protocol=ascii");
  ASSERT_EQ(bench.ask("@0155"), ">");
  ASSERT_EQ(bench.ask("~015P"), "!01");
  ASSERT_EQ(bench.ask("@01FF"), ">");
  ASSERT_EQ(bench.ask("$015"), "!011");
  ASSERT_EQ(bench.ask("$015"), "!010");
  bench.module().hang();
  EXPECT_EQ(bench.ask("$015"), "");
  bench.run(milliseconds(1600 - 250) + milliseconds(100));
  EXPECT_EQ(bench.module().watchdog_resets(), 1U);
  EXPECT_EQ(bench.ask("$015"), "!011");
  EXPECT_EQ(bench.module().outputs(), 0x55);
}

TEST(ModuleWatchdog, AStoppedTickIsResetLikewise) {
  ModuleBench bench("EX9068D-M,protocol=ascii");
  bench.module().stop_tick();
  bench.run(milliseconds(1600));
  EXPECT_EQ(bench.module().watchdog_resets(), 1U);
}

TEST(ModuleWatchdog, AModuleThatIsWellIsNeverReset) {
  ModuleBench bench("EX9068D-M");
  bench.run(std::chrono::hours(3));
  EXPECT_EQ(bench.module().watchdog_resets(), 0U);
}

// --- wire.md 2: reset and INIT* ---

TEST(Reset, OutputsGoFromDeEnergisedToThePowerOnValueWithoutAGlitch) {
  ModuleBench bench("EX9043D");
  ASSERT_EQ(bench.ask("@01A55A"), ">");
  ASSERT_EQ(bench.ask("~015P"), "!01");
  ASSERT_EQ(bench.ask("@01FFFF"), ">");
  std::vector<OutputChange> changes;
  watch_outputs(bench, changes);
  bench.module().reset();
  bench.run(milliseconds(100));
  ASSERT_EQ(changes.size(), 2U);
  EXPECT_EQ(changes[0].channels, 0);
  EXPECT_EQ(changes[1].channels, 0xA55A);
  EXPECT_LT(changes[1].at - changes[0].at, milliseconds(100));
}

TEST(Reset, ABouncingInitSwitchCountsOnlyOnceItStandsStill) {
  ModuleBench bench("EX9042D");
  for (int i = 0; i < 20; ++i) {
    bench.module().set_init(i % 2 == 0);
    bench.run(milliseconds(5));
  }
  bench.module().set_init(false);
  EXPECT_EQ(bench.ask("%0101400700"), "?01");
  bench.module().power(false);
  bench.module().power(true);
  for (int i = 0; i < 10; ++i) {
    bench.module().set_init(i % 2 == 0);
    bench.run(milliseconds(3));
  }
  bench.module().set_init(true);
  bench.run(milliseconds(50));
  EXPECT_EQ(bench.ask("$002"), "!01400600");
}

// --- wire.md 3 and 7: when a reply starts; 9: the driver ---

TEST(Timing, AnAsciiReplyStartsOneCharacterAfterCrAtTheEarliestAndWithin20msOr200WhereSomethingIsStored) {
  for (const std::uint32_t baud : kBaudRates) {
    ModuleBench bench("EX9055D,baud=" + std::to_string(baud));
    for (const auto& [command, most] :
         std::vector<std::pair<std::string, VirtualTime>>{{"$012", milliseconds(20)},
                                                          {"@01FF", milliseconds(20)},
                                                          {"#010", milliseconds(20)},
                                                          {"$01Z", milliseconds(20)},
                                                          {"~01ONEW", milliseconds(200)},
                                                          {"~0131FF", milliseconds(200)}}) {
      bench.recorder().clear();
      ASSERT_NE(bench.ask(command), "") << command;
      const std::size_t request = command.size() + 1;
      const VirtualTime gap = bench.recorder().bytes[request].start - bench.recorder().bytes[request - 1].end;
      EXPECT_GE(gap, VirtualTime(10'000'000'000 / baud)) << command << " at " << baud;
      EXPECT_LE(gap, most) << command << " at " << baud;
    }
  }
}

TEST(Timing, AModbusReplyStartsAfterThreeAndAHalfCharactersAtTheEarliestAndSoon) {
  for (const std::uint32_t baud : kBaudRates) {
    ModuleBench bench("EX9042D-M,baud=" + std::to_string(baud));
    const VirtualTime silence = baud > 19200 ? VirtualTime(1'750'000) : VirtualTime(38'500'000'000 / baud);
    for (const auto& [frame, most] :
         std::vector<std::pair<Bytes, VirtualTime>>{{{1, 0x01, 0, 0, 0, 13}, milliseconds(20)},
                                                    {{1, 0x05, 0, 0, 0xFF, 0}, milliseconds(20)},
                                                    {{1, 0x41}, milliseconds(20)},
                                                    {{1, 0x06, 0x01, 0xE8, 0, 50}, milliseconds(200)}}) {
      bench.recorder().clear();
      ASSERT_FALSE(bench.ask(frame).empty());
      const std::size_t request = frame.size() + 2;
      const VirtualTime gap = bench.recorder().bytes[request].start - bench.recorder().bytes[request - 1].end;
      EXPECT_GE(gap, silence) << baud;
      EXPECT_LE(gap, silence + most) << baud;
    }
  }
}

TEST(Driver, IsOnBeforeTheFirstStartBitAndOffWithinACharacterAfterTheLastStopBit) {
  for (const std::uint32_t baud : kBaudRates) {
    ModuleBench bench("EX9042D,baud=" + std::to_string(baud));
    bench.ask("$01M");
    const auto& drivers = bench.recorder().drivers;
    const auto& bytes = bench.recorder().bytes;
    ASSERT_EQ(drivers.size(), 4U);  // the master's, the module's
    ASSERT_EQ(drivers[2].station, 1U);
    EXPECT_LT(drivers[2].at, bytes[5].start);
    EXPECT_GE(drivers[3].at, bytes.back().end);
    EXPECT_LE(drivers[3].at, bytes.back().end + VirtualTime(10'000'000'000 / baud));
  }
}

TEST(Driver, ItsOwnEchoIsNeverTakenForARequest) {
  // The name is a command for this very module; on two wires it comes back while it is sent.
  ModuleBench bench("EX9042D,name=$01M");
  EXPECT_EQ(bench.ask("$01M"), "!01$01M");
  bench.run(seconds(1));
  EXPECT_EQ(bench.recorder().sent_by(1).size(), 8U);
}

// --- time ---

TEST(Time, NothingHappensWhenTheMicrosecondsWrap) {
  constexpr microseconds kWrap{std::int64_t{1} << 32};
  ModuleBench bench("EX9043D-M");
  ASSERT_EQ(bench.ask(Bytes{1, 0x0F, 0x00, 0x00, 0x00, 0x10, 0x02, 0x0F, 0x00}).at(1), 0x0F);
  ASSERT_EQ(bench.ask(Bytes{1, 0x06, 0x01, 0xE8, 0x00, 0x14}).at(1), 0x06);
  bench.line().bus().run_until(kWrap - milliseconds(1000));
  ASSERT_EQ(bench.ask(Bytes{1, 0x05, 0x01, 0x04, 0xFF, 0x00}).at(1), 0x05);
  const Bytes host_ok = ModuleBench::with_crc({1, 0x03, 0x30, 0x38, 0x00, 0x00});
  // A frame across the wrap.
  bench.line().bus().run_until(kWrap - milliseconds(4));
  bench.send(host_ok);
  const VirtualTime restarted = bench.now() + microseconds(4010);  // T3.5
  ASSERT_GT(restarted, kWrap);
  std::vector<OutputChange> changes;
  watch_outputs(bench, changes);
  bench.run(seconds(3));
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_GE(changes[0].at, restarted + seconds(2));
  EXPECT_LE(changes[0].at, restarted + seconds(2) + milliseconds(1));
  EXPECT_EQ(bench.module().watchdog_resets(), 0U);
}

TEST(Time, AMasterThatPollsOnceAWrapIsAnsweredEveryTime) {
  constexpr microseconds kWrap{std::int64_t{1} << 32};
  ModuleBench bench("EX9042D-M");
  for (int i = 0; i < 5; ++i) {
    const VirtualTime began = bench.now();
    ASSERT_EQ(bench.ask(Bytes{1, 0x01, 0, 0, 0, 13}), (Bytes{1, 0x01, 2, 0, 0}));
    bench.line().bus().run_until(began + kWrap);
  }
}

}  // namespace
}  // namespace ex9000::sim
