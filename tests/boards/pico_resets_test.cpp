// Tests the resets of the images for the Pico in the emulator: by the watchdog, by a fault, and for other
// reasons. To make an image hang, a test changes the code of the image in RAM. After the reset, the second
// stage copies the image from the flash again.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>

#include "tests/boards/pico_image.hpp"

namespace ex9000::pico {
namespace {

class PicoResets : public PicoImage {
 protected:
  void put(std::uint32_t address, unsigned instruction) {
    bench_.execute("write " + std::to_string(address) + " " + std::to_string(instruction));
  }
  /// Replaces the first instruction of an exception's handler.
  void replace_handler(unsigned exception, unsigned instruction) {
    put(number("read " + std::to_string(board::kImageInRam + 4U * exception)) & ~1U, instruction);
  }
  /// Replaces the instruction at which the main loop continues. The processor must be asleep when a test
  /// calls this function. It sleeps most of the time.
  void replace_main_loop(unsigned instruction) { put(number("pc"), instruction); }
};

enum class Doing : std::uint8_t { Nothing, Receiving, Replying, Storing, Erasing };
const char* name_of(Doing doing) {
  constexpr const char* kNames[] = {"Nothing", "Receiving", "Replying", "Storing", "Erasing"};
  return kNames[static_cast<int>(doing)];
}

class HangingPicoImage : public PicoResets, public testing::WithParamInterface<Doing> {
 protected:
  static constexpr milliseconds kLongestErase{400};

  void make_it_busy() {
    switch (GetParam()) {
      case Doing::Nothing:
        break;
      case Doing::Receiving:
        bench_.execute("queue 2430314D2430314D2430314D");
        bench_.run_for(milliseconds(3));
        break;
      case Doing::Replying:
        bench_.send(text("$01M\r"));
        bench_.run_for(milliseconds(3));
        break;
      case Doing::Storing:
        bench_.execute("flash-times 45000000 3000000");  // a page program takes 3 ms
        bench_.send(text("~01OVALVE\r"));
        bench_.run_for(milliseconds(2));
        break;
      case Doing::Erasing:  // as on the first start, with a slow flash
        bench_.power(false);
        bench_.forget_erased_sectors();
        bench_.execute("flash-times " + std::to_string(nanoseconds(kLongestErase).count()) + " 3000000");
        bench_.power(true);
        bench_.run_for(kComingUp);
        break;
    }
  }

  /// Checks that the chip is reset once within the time `within` and for the reason `reason`, and that the
  /// module then works. `count` is the name of the emulator's counter for such resets.
  void expect_reset(const char* count, long reason, nanoseconds within) {
    bench_.run_for(within);
    EXPECT_EQ(bench_.counts().at(count), 1);
    EXPECT_EQ(bench_.counts().at("reason"), reason);
    EXPECT_EQ(bench_.levels() & board::kDriverEnable.mask(), 0U) << "the driver is on";
    // The boot ROM waits until the flash has ended an erase.
    bench_.run_for(kComingUp + (GetParam() == Doing::Erasing ? kLongestErase : milliseconds(0)));
    EXPECT_EQ(bench_.outputs(), kPowerOnValue);
    bench_.heard();
    ask("");
    EXPECT_EQ(ask("$012"), "!01400600\r");
    EXPECT_EQ(bench_.counts().at("timeouts") + bench_.counts().at("requests"), 1);
  }
};

constexpr long kTimeout = 1;
constexpr long kRequest = 2;

TEST_P(HangingPicoImage, IsResetByTheWatchdogIfTheMainLoopHangs) {
  begin();
  ASSERT_EQ(ask("@01C35A"), ">\r");
  ASSERT_EQ(bench_.outputs(), 0xC35A);
  make_it_busy();
  replace_main_loop(kBranchToItself);
  expect_reset("timeouts", kTimeout, kWatchdogPeriod);
}

TEST_P(HangingPicoImage, IsResetByTheWatchdogIfAnInterruptHangs) {
  for (const unsigned exception : {kSystemTick, kUart0}) {
    begin();
    make_it_busy();
    replace_handler(exception, kBranchToItself);
    bench_.execute("queue 24");  // causes a receive interrupt
    expect_reset("timeouts", kTimeout, kWatchdogPeriod);
  }
}

TEST_P(HangingPicoImage, IsResetByTheWatchdogIfTheTickHandlerReturnsImmediately) {
  begin();
  make_it_busy();
  replace_handler(kSystemTick, kReturn);
  expect_reset("timeouts", kTimeout, kWatchdogPeriod);
}

TEST_P(HangingPicoImage, IsResetImmediatelyIfAFaultOccurs) {
  begin();
  make_it_busy();
  replace_handler(kSystemTick, kUndefined);
  expect_reset("requests", kRequest, milliseconds(11));
}

TEST_P(HangingPicoImage, IsResetByTheWatchdogIfAFaultOccursInTheFaultHandler) {
  begin();
  make_it_busy();
  constexpr unsigned kHardFault = 3;
  replace_handler(kHardFault, kUndefined);
  replace_handler(kSystemTick, kUndefined);
  expect_reset("timeouts", kTimeout, kWatchdogPeriod);
}

INSTANTIATE_TEST_SUITE_P(While, HangingPicoImage,
                         testing::Values(Doing::Nothing, Doing::Receiving, Doing::Replying, Doing::Storing,
                                         Doing::Erasing),
                         [](const auto& each) { return name_of(each.param); });

/// firmware/extensions.md, register 0x0301.
TEST_F(PicoResets, TheModuleReportsTheReasonOfEachReset) {
  const std::string ask_reason = "~01X0301";
  begin();
  EXPECT_EQ(ask(ask_reason), "!010001\r");
  for (int pass = 0; pass < 2; ++pass) {
    replace_main_loop(kBranchToItself);
    bench_.run_for(kWatchdogPeriod + kComingUp);
    EXPECT_EQ(ask(ask_reason), "!010002\r");
    replace_handler(kSystemTick, kUndefined);
    bench_.run_for(milliseconds(11) + kComingUp);
    EXPECT_EQ(ask(ask_reason), "!010005\r");
    bench_.reset();
    bench_.run_for(kComingUp);
    EXPECT_EQ(ask(ask_reason), "!010004\r");
    bench_.power(false);
    bench_.power(true);
    bench_.run_for(kComingUp);
    EXPECT_EQ(ask(ask_reason), "!010001\r");
  }
}

// wire.md 2: a crash loop. The count is in a register that only a chip-level reset clears.
TEST_F(PicoResets, TheThirdResetInARowByWatchdogOrFaultLeadsToTheSafeValue) {
  begin();
  for (const std::uint16_t outputs : {kPowerOnValue, kPowerOnValue, kSafeValue, kSafeValue}) {
    if (outputs == kPowerOnValue) {
      replace_main_loop(kBranchToItself);
      bench_.run_for(kWatchdogPeriod + kComingUp);
    } else {
      replace_handler(kSystemTick, kUndefined);
      bench_.run_for(milliseconds(11) + kComingUp);
    }
    EXPECT_EQ(bench_.outputs(), outputs);
  }
  EXPECT_EQ(ask("@010001"), ">\r");
  bench_.reset();
  bench_.run_for(kComingUp);
  EXPECT_EQ(bench_.outputs(), kPowerOnValue);
}

/// After a user has copied an image to the drive of the boot ROM, the boot ROM resets the chip through the
/// watchdog, although the watchdog has not expired.
TEST_F(PicoResets, TheModuleReportsASoftwareResetAfterACopyToTheDrive) {
  begin();
  bench_.power(false);
  bench_.execute("power-after-copy");
  bench_.run_for(kComingUp);
  EXPECT_EQ(ask("~01X0301"), "!010003\r");
  replace_main_loop(kBranchToItself);
  bench_.run_for(kWatchdogPeriod + kComingUp);
  EXPECT_EQ(ask("~01X0301"), "!010002\r");
}

/// wire.md section 6: the driver would jam the line for ever.
TEST_F(PicoResets, TheModuleIsResetIfTheInterruptThatEndsAReplyIsLost) {
  constexpr int kLineEndTimer = 1;
  constexpr int kUart = 20;
  for (const int lost : {kLineEndTimer, kUart}) {
    begin();
    bench_.send(text("$01M\r"));
    bench_.run_for(milliseconds(3));
    ASSERT_NE(bench_.levels() & board::kDriverEnable.mask(), 0U);
    bench_.execute("lose " + std::to_string(lost));
    bench_.run_for(milliseconds(60));  // a reply of nine characters takes 9.4 ms
    ASSERT_NE(bench_.levels() & board::kDriverEnable.mask(), 0U);
    bench_.run_for(milliseconds(60) + kWatchdogPeriod);
    EXPECT_EQ(bench_.counts().at("timeouts"), 1);
    EXPECT_EQ(bench_.levels() & board::kDriverEnable.mask(), 0U);
    bench_.run_for(kComingUp);
    bench_.heard();
    EXPECT_EQ(ask("$01M"), "!019043M\r");
  }
}

TEST_F(PicoResets, BytesWithoutPausesDoNotResetTheModule) {
  begin("EX9043D-M", 115200);
  const nanoseconds end = bench_.now() + 2 * kWatchdogPeriod;
  while (bench_.now() < end) {
    bench_.send(play::Bytes(500, 'U'));
    bench_.send(text("$01"));
  }
  bench_.heard();
  ask("");
  EXPECT_EQ(ask("$01M"), "!019043M\r");
  EXPECT_EQ(bench_.counts().at("timeouts") + bench_.counts().at("requests"), 0);
}

}  // namespace
}  // namespace ex9000::pico
