// Tests extensions on a whole module: timed outputs, input filters, what restarts the host watchdog, reset
// reason, uptime, counts, origin of the settings, and line tallies (firmware/extensions.md).
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "firmware/request/statistics.hpp"
#include "hal/eeprom/two_places.hpp"
#include "sim/app/play/modbus_frame.hpp"
#include "sim/text/values.hpp"
#include "tests/firmware/module_bench.hpp"
#include "tests/support/stored_settings.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

/// A timed output, a filter time and the timeout of the host watchdog may end late by at most this time
/// (firmware/extensions.md; wire.md section 6).
constexpr milliseconds kLatest{1};

std::uint16_t outputs_of(ModuleBench& bench) { return bench.module().outputs(); }

// --- timed outputs ---

TEST(TimedOutput, IsSwitchedOffAtTheEndOfItsTimeOrAtMost1MsLater) {
  for (const unsigned units : {1U, 2U, 7U, 600U}) {
    ModuleBench bench("EX9043D,baud=115200");
    std::vector<OutputChange> changes;
    bench.watch_outputs(changes);
    ASSERT_EQ(bench.ask("~01X0285" + hex_word_text(units)), "!01");
    bench.run(milliseconds(100) * units + seconds(1));
    ASSERT_EQ(changes.size(), 2U) << units;
    EXPECT_EQ(changes[0].channels, 1U << 5U);
    EXPECT_EQ(changes[1].channels, 0U);
    EXPECT_GE(changes[1].at - changes[0].at, milliseconds(100) * units);
    EXPECT_LE(changes[1].at - changes[0].at, milliseconds(100) * units + kLatest);
  }
}

TEST(TimedOutput, IsSwitchedOffInTimeWhileSettingsAreStoredOrAReplyIsSent) {
  for (int offset = 0; offset < 60; ++offset) {
    ModuleBench bench("EX9043D");
    std::vector<OutputChange> changes;
    bench.watch_outputs(changes);
    ASSERT_EQ(bench.ask("~01X02800003"), "!01");  // `ask` waits for 250 ms, so about 50 ms are left
    bench.run(milliseconds(offset));
    bench.send("~01ONAME" + std::to_string(offset % 10) + "\r");
    bench.run(milliseconds(400));
    ASSERT_EQ(changes.size(), 2U) << offset;
    EXPECT_GE(changes[1].at - changes[0].at, milliseconds(300)) << offset;
    EXPECT_LE(changes[1].at - changes[0].at, milliseconds(300) + kLatest) << offset;
  }
}

TEST(TimedOutput, EndsWithTheExpiryOfTheHostWatchdogAndIsNotSwitchedOffLater) {
  ModuleBench bench("EX9043D,baud=115200");
  ASSERT_EQ(bench.ask("@010001"), ">");
  ASSERT_EQ(bench.ask("~015S"), "!01");  // in the safe value, output 0 is on
  ASSERT_EQ(bench.ask("~01X0280000A"), "!01");
  ASSERT_EQ(bench.ask("~013105"), "!01");
  bench.run(milliseconds(500));
  ASSERT_EQ(bench.ask("~010"), "!0104");
  EXPECT_EQ(outputs_of(bench), 0x0001);
  EXPECT_EQ(bench.ask("~01X0280"), "!010000");
  bench.run(seconds(2));
  EXPECT_EQ(outputs_of(bench), 0x0001);
}

TEST(TimedOutput, IsOffAfterAResetAndHasNoTimeLeft) {
  ModuleBench bench("EX9043D,baud=115200");
  ASSERT_EQ(bench.ask("~01X0280FFFF"), "!01");
  ASSERT_EQ(outputs_of(bench), 0x0001);
  bench.module().reset();
  bench.run(milliseconds(100));
  EXPECT_EQ(outputs_of(bench), 0);
  EXPECT_EQ(bench.ask("~01X0280"), "!010000");
}

TEST(TimedOutput, StoresNothing) {
  ModuleBench bench("EX9043D,baud=115200");
  ASSERT_EQ(bench.ask("~01X02800001"), "!01");
  bench.run(seconds(1));
  EXPECT_EQ(bench.ask("~01X0305"), "!010000");
}

// --- filters ---

TEST(InputFilter, ALevelCountsAtTheEndOfTheFilterTimeOrAtMost1MsLater) {
  for (const unsigned time : {1U, 30U, 2000U}) {
    ModuleBench bench("EX9052D,baud=115200");
    ASSERT_EQ(bench.ask("~01X0243" + hex_word_text(time)), "!01");
    bench.module().set_input(3, true);
    bench.run(milliseconds(time));
    const State& state = bench.module().module().state();
    EXPECT_EQ(state.inputs.levels(), 0) << time;
    bench.run(kLatest);
    EXPECT_EQ(state.inputs.levels(), 1U << 3U) << time;
  }
}

TEST(InputFilter, TheLevelAtResetImmediatelyBecomesTheBaseline) {
  ModuleBench bench("EX9052D,baud=115200");
  ASSERT_EQ(bench.ask("~01X024307D0"), "!01");
  ASSERT_EQ(bench.ask("~01X025000F0"), "!01");
  bench.module().power(false);
  bench.module().set_input(3, true);
  bench.module().power(true);
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("@01"), ">F800");
  EXPECT_EQ(bench.ask("$01L1"), "!000000");
}

// The module knows its settings, including the filter times, only some milliseconds after the reset.
TEST(InputFilter, IfALevelChangesWhileTheModuleStartsItCountsAfterTheFilterTime) {
  constexpr milliseconds kFilter{30};
  for (int offset = 1; offset < 40; ++offset) {
    ModuleBench bench("EX9052D,baud=115200");
    ASSERT_EQ(bench.ask("~01X0243001E"), "!01");
    bench.module().power(false);
    bench.module().power(true);
    bench.run(milliseconds(offset));
    bench.module().set_input(3, true);
    bench.run(kFilter);
    const State& state = bench.module().module().state();
    EXPECT_EQ(state.inputs.levels(), 0) << offset;
    bench.run(milliseconds(100));
    EXPECT_EQ(state.inputs.levels(), 1U << 3U) << offset;
    EXPECT_EQ(state.inputs.latched_high(), 1U << 3U) << offset;
  }
}

/// Switches the supply off and on, and lets INIT* bounce until `are_read` returns true for the settings. The
/// module then knows its settings, but it does not listen yet.
template <class AreRead>
void start_while_init_bounces(ModuleBench& bench, AreRead are_read) {
  bench.module().power(false);
  bench.module().power(true);
  while (!are_read(bench.module().module().state().settings)) {
    bench.module().set_init(!bench.module().init_asserted());
    bench.run(milliseconds(1));
  }
}

TEST(InputFilter, APulseCountsEvenIfItEndsBeforeTheModuleListens) {
  ModuleBench bench("EX9052D,baud=115200");
  ASSERT_EQ(bench.ask("~01X02430001"), "!01");
  start_while_init_bounces(bench, [](const Settings& settings) { return settings.input_filters.any(); });
  bench.module().set_input(3, true);
  bench.run(milliseconds(2));
  bench.module().set_init(false);
  bench.module().set_input(3, false);
  ASSERT_FALSE(bench.module().module().listening());
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("$01L1"), "!080000");
  EXPECT_EQ(bench.ask("$01L0"), "!080000");
  EXPECT_EQ(bench.ask("#013"), "!0100001");
}

// The inversion and the counting edge are in force as soon as the settings are read.
TEST(InputInversion, IsInForceBeforeTheModuleListens) {
  ModuleBench bench("EX9052D,baud=115200,edge=rising");
  ASSERT_EQ(bench.ask("~01X02500004"), "!01");
  start_while_init_bounces(bench, [](const Settings& settings) { return settings.inverted_inputs != 0; });
  bench.module().set_init(false);
  bench.module().set_input(1, true);
  bench.module().set_input(2, true);
  bench.run(milliseconds(2));
  ASSERT_FALSE(bench.module().module().listening());
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("#011"), "!0100001");
  EXPECT_EQ(bench.ask("#012"), "!0100000");
  EXPECT_EQ(bench.ask("$01L1"), "!020000");
  EXPECT_EQ(bench.ask("$01L0"), "!040000");
}

// --- requests that restart the host watchdog ---

TEST(FedByRequests, TheEndOfARequestRestartsTheHostWatchdog) {
  ModuleBench bench("EX9043D,baud=115200");
  ASSERT_EQ(bench.ask("@010001"), ">");
  ASSERT_EQ(bench.ask("~01X02510001"), "!01");
  ASSERT_EQ(bench.ask("~013105"), "!01");
  std::vector<OutputChange> changes;
  bench.watch_outputs(changes);
  bench.send("$01Z\r");
  const VirtualTime fed = bench.now();
  bench.run(seconds(1));
  ASSERT_EQ(changes.size(), 1U);
  EXPECT_GE(changes[0].at - fed, milliseconds(500));
  EXPECT_LE(changes[0].at - fed, milliseconds(500) + kLatest);
}

// The second request ends less than a millisecond before or after the time at which the watchdog expires if
// this request does not restart it.
TEST(FedByRequests, OnlyARequestBeforeTheExpiryRestartsTheHostWatchdog) {
  const std::string request = "$01M\r";
  const VirtualTime takes = VirtualTime(10'000'000'000 / 115200) * static_cast<int>(request.size());
  for (const int offset : {-900, -100, -10, 10, 100, 900}) {  // in us
    ModuleBench bench("EX9043D,baud=115200");
    ASSERT_EQ(bench.ask("~01X02510001"), "!01");
    ASSERT_EQ(bench.ask("~01310A"), "!01");
    bench.send(request);
    const VirtualTime expires = bench.now() + seconds(1);
    bench.line().wires().run_until(expires - takes + microseconds(offset));
    bench.send(request);
    bench.run(milliseconds(300));
    EXPECT_EQ(bench.module().module().state().settings.timeout_status, offset > 0) << offset;
  }
}

// A frame ends T3.5 after its last byte. T3.5 is 1.75 ms at 115200 baud.
TEST(FedByRequests, AModbusRequestRestartsTheHostWatchdogAtTheEndOfItsSilence) {
  const std::vector<std::uint8_t> request = with_crc({0x01, 0x01, 0, 0, 0, 1});
  const VirtualTime takes = VirtualTime(10'000'000'000 / 115200) * static_cast<int>(request.size());
  for (const int offset : {-900, -100, -10, 10, 100, 900}) {  // in us
    ModuleBench bench("EX9043D-M,baud=115200");
    ASSERT_EQ(bench.ask(std::vector<std::uint8_t>{0x01, 0x06, 0x02, 0x51, 0, 1}).size(), 6U);
    ASSERT_EQ(bench.ask(std::vector<std::uint8_t>{0x01, 0x06, 0x01, 0xE8, 0, 10}).size(), 6U);
    ASSERT_EQ(bench.ask(std::vector<std::uint8_t>{0x01, 0x05, 0x01, 0x04, 0xFF, 0}).size(), 6U);
    bench.send(request);
    const VirtualTime expires = bench.now() + microseconds(1750) + seconds(1);
    bench.line().wires().run_until(expires - takes - microseconds(1750) + microseconds(offset));
    bench.send(request);
    bench.run(milliseconds(300));
    EXPECT_EQ(bench.module().module().state().settings.timeout_status, offset > 0) << offset;
  }
}

// --- reset reason, uptime and timeout count ---

TEST(ResetReasons, DifferForPowerOnForTheResetPinAndForTheModuleWatchdog) {
  ModuleBench bench("EX9043D,baud=115200");
  EXPECT_EQ(bench.ask("~01X0301"), "!010001");
  bench.module().reset();
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("~01X0301"), "!010004");
  bench.module().hang();
  bench.run(seconds(3));
  EXPECT_EQ(bench.ask("~01X0301"), "!010002");
  bench.power_cycle();
  EXPECT_EQ(bench.ask("~01X0301"), "!010001");
}

TEST(Uptime, CountsSecondsBeyondTheRangeOfTheClock) {
  ModuleBench bench("EX9043D,baud=115200");
  bench.run(std::chrono::hours(2));
  const std::string reply = bench.ask("~01X0302");
  ASSERT_EQ(reply.size(), 11U);
  EXPECT_EQ(reply.substr(3), "00001C20");  // 7200
  bench.run(std::chrono::hours(17));
  EXPECT_EQ(bench.ask("~01X0302").substr(3), "00010B30");  // 68400, beyond 16 bits
  bench.module().reset();
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("~01X0302"), "!0100000000");
}

TEST(TimeoutCount, CountsEveryExpiryAndIsClearedByAWriteOf0) {
  ModuleBench bench("EX9043D,baud=115200");
  for (int i = 0; i < 3; ++i) {
    ASSERT_EQ(bench.ask("~013101"), "!01");
  }
  EXPECT_EQ(bench.ask("~01X0304"), "!010003");
  EXPECT_EQ(bench.ask("~01X03040001"), "?01");
  EXPECT_EQ(bench.ask("~01X03040000"), "!01");
  EXPECT_EQ(bench.ask("~01X0304"), "!010000");
}

// --- origin of the settings, and counts ---

void restart_with(ModuleBench& bench, const std::vector<std::uint8_t>& memory) {
  bench.module().power(false);
  std::copy(memory.begin(), memory.end(), bench.module().memory().contents().begin());
  bench.module().power(true);
  bench.run(milliseconds(100));
}

/// Returns the value of register 0x0306 of the module `model` after it has started with `memory`.
std::string settings_source(const std::string& model, const std::vector<std::uint8_t>& memory) {
  ModuleBench bench(model);
  restart_with(bench, memory);
  return bench.ask("~" + hex_byte_text(bench.module().module().state().in_force.address) + "X0306").substr(3);
}

TEST(SettingsSourceRegister, ReturnsTheSourceOfTheSettings) {
  const Model& model = *find_model("EX9043D");
  EXPECT_EQ(settings_source("EX9043D", std::vector<std::uint8_t>(0x100, 0xFF)), "0004");
  Settings settings = Settings::factory(model);
  settings.watchdog_timeout = 0x11;
  std::vector<std::uint8_t> memory = SimulatedModule::memory_image(model, settings);
  EXPECT_EQ(settings_source("EX9043D", memory), "0000");  // the second copy is blank
  std::vector<std::uint8_t> one_bad = memory;
  one_bad[hal::kPlaces[1]] = 0x00;
  EXPECT_EQ(settings_source("EX9043D", one_bad), "0001");
  one_bad[hal::kPlaces[0] + 8U] ^= 1U;
  EXPECT_EQ(settings_source("EX9043D", one_bad), "0002");
}

TEST(TimeoutCount, StopsAt65535) {
  ModuleBench bench("EX9043D,baud=115200");
  for (int i = 0; i < 0xFFFF; ++i) {
    bench.send("~013101\r");
    bench.run(milliseconds(200));
  }
  EXPECT_EQ(bench.ask("~01X0304"), "!01FFFF");
  ASSERT_EQ(bench.ask("~013101"), "!01");
  EXPECT_EQ(bench.ask("~01X0304"), "!01FFFF");
}

// --- line tallies ---

std::vector<std::uint8_t> read_word(std::uint8_t high, std::uint8_t low) {
  return {0x01, 0x03, high, low, 0, 1};
}

TEST(LineTallyRegisters, CountRequestsLostDuringAStoreAndAreClearedByFunction08) {
  ModuleBench bench("EX9043D-M,baud=115200");
  bench.recorder().clear();
  bench.send(with_crc({0x01, 0x06, 0x01, 0xE8, 0, 50}));
  for (int i = 0; i < 3; ++i) {
    bench.run(microseconds(1900));
    bench.send(with_crc({0x01, 0x01, 0, 0, 0, 1}));
  }
  bench.run(milliseconds(100));
  // The reply to the request that stores has 8 bytes, and each reply to a read request has 6.
  const std::size_t replied = (bench.recorder().sent_by(1).size() - 8) / 6;
  ASSERT_LT(replied, 3U);
  EXPECT_EQ(bench.ask(read_word(0x03, 0x0F)),
            (std::vector<std::uint8_t>{0x01, 0x03, 2, 0, static_cast<std::uint8_t>(3 - replied)}));
  ASSERT_EQ(bench.ask(std::vector<std::uint8_t>{0x01, 0x08, 0, 0x0A, 0, 0}).size(), 6U);
  EXPECT_EQ(bench.ask(read_word(0x03, 0x0F)), (std::vector<std::uint8_t>{0x01, 0x03, 2, 0, 0}));
}

TEST(LineTallyRegisters, CountDamagedBytesModulo65536) {
  ModuleBench bench("EX9043D-M,baud=115200");
  for (unsigned i = 0; i < 0x10004; ++i) {
    bench.module().receive(0x55, i % 2 == 0 ? ByteStatus::FramingError : ByteStatus::ParityError);
  }
  bench.run(milliseconds(10));
  EXPECT_EQ(bench.ask(read_word(0x03, 0x0E)), (std::vector<std::uint8_t>{0x01, 0x03, 2, 0, 4}));
}

TEST(Statistics, ACountStopsAt65535) {
  std::uint16_t count = 0xFFFE;
  count_saturating(count);
  EXPECT_EQ(count, 0xFFFF);
  count_saturating(count);
  EXPECT_EQ(count, 0xFFFF);
}

}  // namespace
}  // namespace ex9000::sim
