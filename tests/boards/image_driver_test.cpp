// Tests images on simulated boards, for example with faults of the EEPROM and of the line, and with short
// pulses at the inputs. Also tests resets, the INIT* switch, the status LED and a long uptime.
#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>
#include <vector>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "sim/virtual_line/wires/module.hpp"
#include "tests/boards/images_under_test.hpp"
#include "tests/mcu_model/board_bench.hpp"

namespace ex9000::registers {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds kComesUpWithin{100};

class OnBoard : public testing::TestWithParam<ImageName> {
 protected:
  explicit OnBoard(I2cBehaviour behaviour = {})
      : bench(image_of(GetParam().board, GetParam().model), behaviour) {}

  void power_up() {
    bench.power_on();
    bench.run_for(kComesUpWithin);
  }
  UartPort& uart() { return bench.image.uart == 0 ? bench.mcu->uart0 : bench.mcu->uart1; }
  bool listens() { return uart().enabled(); }
  /// Switches the supply on, with the EEPROM and its bus in their present state. Checks that the module
  /// receives after kComesUpWithin, replies with its factory name, and causes no reset.
  void expect_comes_up() {
    power_up();
    EXPECT_TRUE(listens());
    EXPECT_EQ(bench.resets, 0U);
    EXPECT_EQ(bench.ask("$01M"), "!019055");
  }
  Net& clock() { return bench.pins.at('B', I2cBlock::kClockPin); }
  Net& data() { return bench.pins.at('B', I2cBlock::kDataPin); }

  void expect_lives_with_stuck_lines() {
    for (Net* line : {&clock(), &data()}) {
      bench.power_off();
      line->drive(End::Fault, Drive::Low);
      expect_comes_up();
      EXPECT_EQ(bench.ask("~01OPUMP"), "?01");
      line->drive(End::Fault, Drive::Nothing);
      // In this time, the module invalidates the copy that the refused store may have written.
      bench.run_for(seconds(3));
      EXPECT_EQ(bench.ask("~01O9055"), "!01");
      line->drive(End::Fault, Drive::Low);
      EXPECT_EQ(bench.ask("~01OPUMP"), "?01");
      line->drive(End::Fault, Drive::Nothing);
      bench.run_for(seconds(3));
      EXPECT_EQ(bench.ask("~01O9055"), "!01");
      EXPECT_EQ(bench.ask("$01M"), "!019055");
    }
  }

  BoardBench bench;
};

/// A board whose I2C controller waits for a reset if a START finds the bus busy, and raises an interrupt
/// after a STOP without a byte. The data sheets do not define these cases.
class OnBoardWhoseI2cWaits : public OnBoard {
 protected:
  OnBoardWhoseI2cWaits() : OnBoard({true, false, true}) {}
};

TEST_P(OnBoard, ComesUpWithin100msWithoutAnEepromAndRefusesToStore) {
  bench.eeprom.remove(true);
  expect_comes_up();
  EXPECT_EQ(bench.ask("~01OPUMP"), "?01");
  EXPECT_EQ(bench.ask("$01M"), "!019055");
}

TEST_P(OnBoard, ComesUpWithin100msWhileTheEepromStillPrograms) {
  power_up();
  bench.eeprom.set_programming_time(milliseconds(10));
  bench.line.send({'~', '0', '1', 'O', 'P', 'U', 'M', 'P', '\r'});
  while (!bench.eeprom.programming()) {
    bench.run_for(microseconds(500));
  }
  bench.reset();
  bench.run_for(kComesUpWithin);
  EXPECT_TRUE(listens());
  EXPECT_EQ(bench.ask("$01M"), "!01PUMP");
}

TEST_P(OnBoard, ComesUpWithin100msWithAStuckEepromBusAndStoresWhenItIsFree) {
  expect_lives_with_stuck_lines();
}

TEST_P(OnBoardWhoseI2cWaits, ComesUpWithin100msWithAStuckEepromBusAndStoresWhenItIsFree) {
  expect_lives_with_stuck_lines();
}

TEST_P(OnBoard, TheDriverIsOffUnlessTheModuleReplies) {
  power_up();
  EXPECT_TRUE(bench.line.drives.empty());
  bench.ask("$01M");
  bench.ask("$02M");
  ASSERT_EQ(bench.line.drives.size(), 1U);
  EXPECT_EQ(bench.line.bits_lost, 0U);
}

TEST_P(OnBoard, RestoresADisturbedOutputOrLedPinAtTheNextTick) {
  constexpr microseconds kATick{10'050};  // a tick, and the time that the main loop needs after it
  power_up();
  ASSERT_EQ(bench.ask("@01A5"), ">");
  const auto disturb = [this](PinPlace place) {
    GpioPort& port = bench.mcu->port(place.port);
    // The address of the data register contains the mask.
    const std::uint32_t only_this_one = (1U << place.pin) << 2U;
    port.write(only_this_one, ~port.read(only_this_one));
  };
  for (unsigned phase = 0; phase < 5; ++phase) {
    for (unsigned channel = 0; channel < bench.image.outputs; ++channel) {
      bench.run_for(microseconds(11'300));
      disturb(bench.image.output_pins.at(channel));
      EXPECT_EQ(bench.outputs(), 0xA5U ^ (1U << channel)) << "the test did not reach the tested case";
      bench.run_for(kATick);
      EXPECT_EQ(bench.outputs(), 0xA5U) << channel;
    }
    disturb(bench.image.status_led);
    EXPECT_FALSE(bench.led());
    bench.run_for(kATick);
    EXPECT_TRUE(bench.led());
  }
  EXPECT_EQ(bench.resets, 0U);
}

TEST_P(OnBoard, IgnoresABreakBetweenRequestsAndDropsARequestThatContainsABreak) {
  constexpr Character kBreak{0, true, 30};
  power_up();
  bench.line.send_one(kBreak);
  EXPECT_EQ(bench.ask("$01M"), "!019055");
  bench.line.send({'$', '0', '1', 'M'});
  bench.line.send_one(kBreak);
  EXPECT_EQ(bench.ask(""), "");
  EXPECT_EQ(bench.ask("$01M"), "!019055");
}

TEST_P(OnBoard, DropsARequestThatHasACharacterWithoutAStopBit) {
  power_up();
  bench.line.send({'$', '0', '1'});
  bench.line.send_one({'M', false, 0});
  bench.run_for(milliseconds(5));
  EXPECT_EQ(bench.ask(""), "");
  bench.line.send({'$', '0', '1', 'M'});
  bench.line.send_one({'\r', false, 0});  // a character with a wrong stop bit may have been any character
  bench.run_for(milliseconds(100));
  EXPECT_TRUE(bench.line.heard.empty());
  EXPECT_EQ(bench.ask(""), "") << "the module must drop a request that contains a damaged character";
  EXPECT_EQ(bench.ask("$01M"), "!019055");
}

TEST_P(OnBoard, DropsARequestIfAnOverrunLosesACharacterOfIt) {
  power_up();
  bench.line.send({'~', '0', '1', 'O', 'P', 'U'});
  bench.run_for(milliseconds(8));
  bench.mcu->core.set_latency(milliseconds(3));
  bench.line.send({'M', 'M', 'M', 'M'});
  bench.run_for(milliseconds(8));
  ASSERT_GT(uart().overruns(), 0U);
  bench.mcu->core.set_latency(Instant(0));
  EXPECT_EQ(bench.ask("P"), "");
  EXPECT_EQ(bench.ask("$01M"), "!019055");
}

TEST_P(OnBoard, AcceptsAHostOkIfASecondHostOkFollowsWithoutAPause) {
  const Model& model = *find_model(bench.image.model);
  Settings settings = Settings::factory(model);
  settings.baud_code = 0x0A;  // at 115200 baud a host OK takes 0.35 ms
  bench.memory = sim::SimulatedModule::memory_image(model, settings);
  power_up();
  bench.line.set_baud(115200);
  const std::vector<std::uint8_t> host_ok{'~', '*', '*', '\r'};
  const Instant takes = 40 * bench.line.bit_time();
  ASSERT_EQ(bench.ask("~013101"), "!01");
  for (int phase = 0; phase < 20; ++phase) {
    bench.line.send(host_ok);
    bench.run_for(takes);
    // If the module lost the first of the next two host OKs, the host watchdog would expire before the end of
    // the second one.
    bench.run_for(milliseconds(100) - 2 * takes + takes / 2);
    bench.line.send(host_ok);
    bench.line.send(host_ok);
    bench.run_for(milliseconds(20) + microseconds(50) * phase);
    ASSERT_EQ(bench.ask("~010"), "!0100") << phase;
  }
}

TEST_P(OnBoard, CountsShortPulsesOnEveryInputDespiteInterruptLatency) {
  power_up();
  bench.mcu->core.set_latency(microseconds(10));
  for (unsigned channel = 0; channel < bench.image.inputs; ++channel) {
    for (int i = 0; i < 7; ++i) {
      // The pulse is so short that, when the handler runs, both edges have set the same flag and the level is
      // back at its old value.
      bench.set_input(channel, true);
      bench.run_for(microseconds(i));
      bench.set_input(channel, false);
      bench.run_for(microseconds(100));
    }
    EXPECT_EQ(bench.ask("#01" + std::to_string(channel)), "!0100007") << channel;
  }
}

TEST_P(OnBoard, CountsAndLatchesNoEdgesAtStartIfInputsAreHighOrLow) {
  for (unsigned channel = 0; channel < bench.image.inputs; ++channel) {
    bench.set_input(channel, channel % 3 != 0);
  }
  power_up();
  for (unsigned channel = 0; channel < bench.image.inputs; ++channel) {
    EXPECT_EQ(bench.ask("#01" + std::to_string(channel)), "!0100000") << channel;
  }
  EXPECT_EQ(bench.ask("$01L1"), "!000000") << "a latch is set";
  EXPECT_EQ(bench.ask("$01L0"), "!000000") << "a latch is set";
}

/// firmware/extensions.md, register 0x0301.
TEST_P(OnBoard, ReportsTheReasonOfTheLastReset) {
  constexpr milliseconds kLongestWatchdogPeriod{1600};
  constexpr unsigned kUnserved = 7;  // SSI0
  const std::string ask_reason = "~01X0301";
  power_up();
  EXPECT_EQ(bench.ask(ask_reason), "!010001");
  for (int pass = 0; pass < 2; ++pass) {
    bench.mcu->hang(Hangs::MainLoop);
    bench.run_for(kLongestWatchdogPeriod + kComesUpWithin);
    EXPECT_EQ(bench.watchdog_resets, 1U + static_cast<unsigned>(pass));
    EXPECT_EQ(bench.ask(ask_reason), "!010002");
    // An unexpected interrupt has the same reason, 5, as a fault.
    bench.mcu->core.write(Core::kSetEnable, 1U << kUnserved);
    bench.mcu->core.stick(kUnserved);
    bench.run_for(kComesUpWithin);
    EXPECT_EQ(bench.resets, 2U + 2U * static_cast<unsigned>(pass));
    EXPECT_EQ(bench.ask(ask_reason), "!010005");
    bench.reset();
    bench.run_for(kComesUpWithin);
    EXPECT_EQ(bench.ask(ask_reason), "!010004");
    EXPECT_EQ(bench.ask(ask_reason), "!010004");
    bench.power_off();
    power_up();
    EXPECT_EQ(bench.ask(ask_reason), "!010001");
  }
}

/// wire.md D13. If the module sampled the bouncing switch only every 10 ms, the switch would seem to be
/// stable.
TEST_P(OnBoard, TreatsAnInitSwitchThatBouncesAfterResetAsReleased) {
  for (const bool most_of_the_time : {true, false}) {
    for (int phase = 0; phase < 10; ++phase) {
      bench.power_off();
      bench.run_for(milliseconds(20));
      bench.set_init(!most_of_the_time);
      bench.power_on();
      bench.run_for(milliseconds(phase));
      for (int i = 0; i < 8; ++i) {
        bench.set_init(most_of_the_time);
        bench.run_for(milliseconds(8));
        bench.set_init(!most_of_the_time);
        bench.run_for(milliseconds(2));
      }
      EXPECT_EQ(bench.ask("$01M"), "!019055") << phase;
      EXPECT_EQ(bench.ask("$00M"), "") << phase;
      bench.set_init(false);
    }
  }
}

TEST_P(OnBoard, ListensWithin30msOfResetIfTheInitSwitchDoesNotBounce) {
  for (const bool init : {false, true}) {
    bench.power_off();
    bench.run_for(milliseconds(20));
    bench.set_init(init);
    bench.power_on();
    bench.run_for(milliseconds(30));
    EXPECT_TRUE(listens());
    EXPECT_EQ(bench.ask(init ? "$00M" : "$01M"), init ? "!009055" : "!019055");
  }
}

/// wire.md 6: the LED flashes at 2 Hz.
TEST_P(OnBoard, TogglesItsFlashingLedEvery250msWithAnErrorOfAtMost1ms) {
  power_up();
  // The net calls this function as long as the net exists, so the function shares ownership of the list.
  const auto changes = std::make_shared<std::vector<Instant>>();
  bench.net(bench.image.status_led).on_change([this, changes] { changes->push_back(bench.timeline.now()); });
  ASSERT_EQ(bench.ask("~013103"), "!01");
  bench.run_for(seconds(4));
  ASSERT_GE(changes->size(), 12U);
  for (std::size_t i = 1; i < changes->size(); ++i) {
    const Instant phase = changes->at(i) - changes->at(i - 1);
    EXPECT_GE(phase, milliseconds(249)) << i;
    EXPECT_LE(phase, milliseconds(251)) << i;
  }
}

TEST_P(OnBoard, RunsForAMinuteWithoutAReset) {
  bench.power_on();
  bench.run_for(seconds(60));
  EXPECT_EQ(bench.resets, 0U);
  EXPECT_FALSE(bench.mcu->watchdog.flagged());
  EXPECT_GT(bench.mcu->watchdog.feeds(), 100U);
  EXPECT_EQ(bench.ask("$01M"), "!019055");
}

TEST_P(OnBoard, AccessesNoRegisterWhileInterruptsAreDisabled) {
  power_up();
  bench.ask("~01OPUMP");
  EXPECT_EQ(bench.mcu->most_accesses_held(), 0U);
}

/// In this image, each 32-bit count that the interrupts and the main loop share is about to wrap
/// (tests/support/long_uptime).
class OnBoardForMonths : public OnBoard {};

TEST_P(OnBoardForMonths, WorksAcrossTheWrapOfEvery32BitCount) {
  power_up();
  // The times from the end of a command that stores a setting until the module begins its reply.
  Instant shortest = kNever;
  Instant longest{0};
  const auto store = [&](const std::string& command) {
    bench.line.drives.clear();
    ASSERT_EQ(bench.ask(command), "!01");
    const Instant silence = bench.line.drives.at(0).from - bench.line.sent();
    shortest = std::min(shortest, silence);
    longest = std::max(longest, silence);
  };
  store("~013114");  // a timeout of 2 s; each round is shorter
  for (unsigned round = 1; round <= 150; ++round) {
    bench.line.send({'~', '*', '*', '\r'});
    bench.run_for(milliseconds(10));
    bench.set_input(3, true);
    bench.run_for(milliseconds(1));
    ASSERT_EQ(bench.ask("$016"), "!000800") << round;
    bench.set_input(3, false);
    bench.run_for(milliseconds(1));
    const std::string count = std::to_string(round);
    ASSERT_EQ(bench.ask("#013"), "!01" + std::string(5 - count.size(), '0') + count);
    store("~01OPUMP" + std::to_string(round % 2));
    ASSERT_EQ(bench.ask("~010"), "!0100") << round;
  }
  EXPECT_EQ(bench.ask("$01M"), "!01PUMP0");
  // If the I2C driver did not detect the end of a byte, its timeout of 3 ms would expire, and the reply would
  // begin more than 2 ms later.
  EXPECT_LT(std::chrono::duration<double>(longest - shortest).count(), 0.002);
  bench.run_for(seconds(2));
  EXPECT_EQ(bench.ask("~010"), "!0104");
  EXPECT_EQ(bench.resets, 0U);
}

const auto kImages =
    testing::Values(ImageName{"lm3s6965evb", "EX9055D"}, ImageName{"ek-tm4c123gxl", "EX9055D"});
INSTANTIATE_TEST_SUITE_P(Images, OnBoard, kImages, name_of);
INSTANTIATE_TEST_SUITE_P(Images, OnBoardWhoseI2cWaits, kImages, name_of);
INSTANTIATE_TEST_SUITE_P(Images, OnBoardForMonths,
                         testing::Values(ImageName{"ek-tm4c123gxl", "EX9055D_after_months"}), name_of);

}  // namespace
}  // namespace ex9000::registers
