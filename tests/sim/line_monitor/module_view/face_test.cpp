// Tests that a Face contains the part of a module's state that viewers show, and that reading a Face does not
// change the module. Also tests the names of a module's terminals.
#include "sim/line_monitor/module_view/face.hpp"

#include <gtest/gtest.h>

#include <set>
#include <string>

#include "sim/line_monitor/module_view/terminals.hpp"
#include "tests/firmware/module_bench.hpp"

namespace ex9000::sim {
namespace {

using Bytes = ModuleBench::Bytes;
using std::chrono::milliseconds;

Face face_of(ModuleBench& bench) { return face_of(bench.module(), bench.now()); }

TEST(Face, ShowsTheActiveSettingsAndTheLed) {
  ModuleBench bench("EX9042D@2A,baud=19200,format=8E1,checksum=on,name=PUMPS");
  const Plate plate = face_of(bench).plate;
  EXPECT_TRUE(plate.switched_on && plate.powered && plate.listening);
  EXPECT_FALSE(plate.init || plate.init_mode);
  EXPECT_EQ(plate.address, 0x2A);
  EXPECT_EQ(plate.mode, (SerialMode{19200, LineFormat::k8E1}));
  EXPECT_EQ(plate.protocol, Protocol::Ascii);
  EXPECT_TRUE(plate.checksum);
  EXPECT_EQ(plate.led, Led::On);
  EXPECT_EQ(name_text(face_of(bench).stored.settings), "PUMPS");
}

TEST(Face, ShowsOutputsInputsCountersAndLatches) {
  ModuleBench bench("EX9055D");
  ASSERT_EQ(bench.ask("@0105"), ">");
  bench.module().set_input(1, true);
  bench.module().pulse_input(7, 3);
  bench.run(milliseconds(1));
  const Face face = face_of(bench);
  EXPECT_EQ(face.plate.outputs, 0x05);
  EXPECT_EQ(face.plate.inputs, 0x02);
  EXPECT_EQ(face.records.latched_high, 0x82);
  EXPECT_EQ(face.records.latched_low, 0x80);
  EXPECT_EQ(face.records.counters[7], 3U);
  EXPECT_EQ(face.records.counters[1], 0U);
}

TEST(Face, ShowsTheRemainingTimeOfATimedOutput) {
  ModuleBench bench("EX9055D");
  ASSERT_EQ(bench.ask("~01X02800064"), "!01");  // output 0 for 10 s
  EXPECT_GT(face_of(bench).plate.timers[0], 90U);
  ASSERT_EQ(bench.ask("~01X02820064"), "!01");  // output 2 for 10 s
  const unsigned left = face_of(bench).plate.timers[2];
  EXPECT_GT(left, 90U);
  bench.run(milliseconds(1000));
  EXPECT_EQ(face_of(bench).plate.timers[2], left - 10);
  EXPECT_EQ(face_of(bench).plate.timers[1], 0);
  bench.run(milliseconds(10'000));
  EXPECT_EQ(face_of(bench).plate.timers[2], 0);
}

TEST(Face, WithoutPowerShowsSwitchesInputsAndStoredSettingsButNoFirmwareState) {
  ModuleBench bench("EX9055D@07");
  ASSERT_EQ(bench.ask("@0705"), ">");
  bench.module().set_input(0, true);
  bench.module().set_init(true);
  bench.module().power(false);
  const Face face = face_of(bench);
  EXPECT_FALSE(face.plate.switched_on || face.plate.powered || face.plate.listening);
  EXPECT_TRUE(face.plate.init);
  EXPECT_EQ(face.plate.led, Led::Off);
  EXPECT_EQ(face.plate.outputs, 0);
  EXPECT_EQ(face.plate.inputs, 0x01);  // the level at the terminal does not depend on the supply
  EXPECT_EQ(face.records, InputRecords());
  EXPECT_EQ(face.host_watchdog, HostWatchdogState());
  EXPECT_EQ(face.stored.settings.address, 0x07);
}

TEST(Face, AnInterruptedSupplyLeavesThePowerSwitchOn) {
  ModuleBench bench("EX9055D");
  bench.module().interrupt_supply(true);
  EXPECT_TRUE(face_of(bench).plate.switched_on);
  EXPECT_FALSE(face_of(bench).plate.powered);
}

TEST(Face, ShowsInitModeOnlyAfterAReset) {
  ModuleBench bench("EX9042D-M@2A");
  bench.module().set_init(true);
  bench.run(milliseconds(100));
  EXPECT_TRUE(face_of(bench).plate.init);
  EXPECT_FALSE(face_of(bench).plate.init_mode);
  bench.power_cycle();
  EXPECT_TRUE(face_of(bench).plate.init_mode);
  EXPECT_EQ(face_of(bench).plate.address, 0x00);
}

TEST(Face, ShowsWhenTheHostWatchdogExpiresAndThatItHasExpired) {
  ModuleBench bench("EX9043D");
  ASSERT_EQ(bench.ask("@010002"), ">");
  ASSERT_EQ(bench.ask("~015S"), "!01");
  ASSERT_EQ(bench.ask("@010001"), ">");
  EXPECT_FALSE(face_of(bench).host_watchdog.expires);
  ASSERT_EQ(bench.ask("~01310A"), "!01");
  const HostWatchdogState runs = face_of(bench).host_watchdog;
  EXPECT_TRUE(runs.enabled);
  EXPECT_EQ(runs.timeout, 10);
  ASSERT_TRUE(runs.expires);
  EXPECT_GT(*runs.expires, bench.now());
  bench.run(milliseconds(100));
  EXPECT_EQ(face_of(bench).host_watchdog, runs);  // `expires` is the time of expiry, not the remaining time
  bench.line().wires().run_until(*runs.expires - milliseconds(1));
  EXPECT_FALSE(face_of(bench).host_watchdog.timed_out);
  bench.run(milliseconds(2));
  const Face expired = face_of(bench);
  EXPECT_TRUE(expired.host_watchdog.timed_out);
  EXPECT_FALSE(expired.host_watchdog.expires);
  EXPECT_EQ(expired.plate.led, Led::HostTimeout);
  EXPECT_EQ(expired.plate.outputs, 0x02);
}

TEST(Face, ShowsTheCurrentCopyOfTheSettings) {
  ModuleBench bench("EX9042D");
  EXPECT_TRUE(face_of(bench).stored.blank);
  EXPECT_EQ(face_of(bench).stored.settings, Settings::factory(bench.module().model()));
  for (const std::string name : {"ONE", "TWO", "THREE"}) {
    ASSERT_EQ(bench.ask("~01O" + name), "!01");
    const Stored stored = face_of(bench).stored;
    EXPECT_FALSE(stored.blank);
    ASSERT_TRUE(stored.current);
    EXPECT_EQ(name_text(stored.settings), name);
    EXPECT_EQ(stored.settings, bench.module().module().state().settings);
  }
}

TEST(Face, IgnoresADamagedCopyOfTheSettings) {
  ModuleBench bench("EX9042D");
  ASSERT_EQ(bench.ask("~01OONE"), "!01");
  ASSERT_EQ(bench.ask("~01OTWO"), "!01");
  const std::size_t current = *face_of(bench).stored.current;
  bench.module().memory().contents()[hal::kPlaces[current]] ^= 1U;
  const Stored stored = face_of(bench).stored;
  EXPECT_FALSE(stored.copies[current].sequence);
  EXPECT_EQ(stored.current, 1 - current);
  EXPECT_EQ(name_text(stored.settings), "ONE");
}

TEST(Face, TheLedShowsUnreadableSettings) {
  ModuleBench bench("EX9042D");
  bench.module().memory().contents()[hal::kPlaces[0]] = 0;
  bench.module().memory().contents()[hal::kPlaces[1]] = 0;
  bench.power_cycle();
  EXPECT_EQ(face_of(bench).plate.led, Led::SettingsUnreadable);
  EXPECT_FALSE(face_of(bench).stored.current);
}

TEST(Face, ReadingAFaceDoesNotChangeTheModule) {
  ModuleBench looked("EX9055D");
  ModuleBench left("EX9055D");
  for (int i = 0; i < 200; ++i) {
    for (ModuleBench* bench : {&looked, &left}) {
      bench->send(i % 2 == 0 ? "@01\r" : "~013105\r");
      bench->module().set_input(3, i % 3 == 0);
      bench->run(milliseconds(7 * (i % 5)));
    }
    static_cast<void>(face_of(looked));
  }
  EXPECT_EQ(looked.heard_text(), left.heard_text());
  EXPECT_EQ(looked.module().memory().contents(), left.module().memory().contents());
  EXPECT_EQ(looked.line().wires().next(), left.line().wires().next());
  EXPECT_EQ(looked.line().faults_so_far(), nullptr);
}

TEST(Terminals, RelaysAreNumberedFromOneAndOpenCollectorsFromZero) {
  for (const Model& model : kModels) {
    const bool relays = model.description.find("relay") != std::string_view::npos ||
                        model.description.find("PhotoMOS") != std::string_view::npos;
    if (model.has_outputs()) {
      EXPECT_EQ(output_terminal(model, 0), relays ? "RL1" : "DO0") << model.designation;
    }
  }
  EXPECT_EQ(output_terminal(*find_model("EX9068D-M"), 7), "RL8");
  EXPECT_EQ(output_terminal(*find_model("EX9042D-M"), 12), "DO12");
  EXPECT_EQ(input_terminal(7), "DI7");
}

}  // namespace
}  // namespace ex9000::sim
