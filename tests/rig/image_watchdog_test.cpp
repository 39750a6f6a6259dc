// An image that has been made to hang: its hardware watchdog brings it back. Nothing of the image is changed:
// what makes it hang lies in RAM it does not use, and is entered by the vector table, which a reset puts
// back.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/rig/master.hpp"

namespace ex9000::rig {
namespace {

constexpr std::uint32_t kSysTickControl = 0xE000'E010;
constexpr std::uint32_t kVectorTableOffset = 0xE000'ED08;
constexpr std::uint32_t kVectors = 16 + 48;
constexpr std::uint32_t kSysTickVector = 15;
/// Between what the image keeps in RAM, at its bottom, and its stack, at its top.
constexpr std::uint32_t kTable = 0x2000'8000;
constexpr std::uint32_t kCode = 0x2000'8400;
constexpr std::uint32_t kThumb = 1;

class HungImage : public testing::Test {
 protected:
  HungImage() {
    module_.power(true);
    wait_until_up(module_);
    EXPECT_EQ(ask(module_, "@010A05"), ">");
    EXPECT_EQ(ask(module_, "~015P"), "!01");
    EXPECT_EQ(ask(module_, "@011FFF"), ">");
    EXPECT_EQ(ask(module_, "$015"), "!011");
    EXPECT_EQ(ask(module_, "$015"), "!010");
    EXPECT_EQ(module_.outputs(), 0x1FFF);
  }

  QtestClient& bus() { return module_.emulator().bus(); }

  /// From the next tick on the tick's interrupt is this code.
  void make_tick_run(const std::vector<std::uint32_t>& code) {
    for (std::uint32_t i = 0; i < kVectors; ++i) {
      bus().write(kTable + 4 * i, bus().read(4 * i));
    }
    std::uint32_t at = kCode;
    for (const std::uint32_t word : code) {
      bus().write(at, word);
      at += 4;
    }
    bus().write(kTable + 4 * kSysTickVector, kCode | kThumb);
    bus().write(kVectorTableOffset, kTable);
  }

  void expect_reset_because(const std::string& event) {
    ASSERT_TRUE(module_.halts_because(event));
    module_.come_up_again();
    wait_until_up(module_);
    EXPECT_EQ(ask(module_, "$015"), "!011");
    EXPECT_EQ(module_.outputs(), 0x0A05);
    EXPECT_EQ(ask(module_, "@01"), ">0A05");
    EXPECT_EQ(ask(module_, "$015"), "!010");
  }

  const Model& model_ = *find_model("EX9042D-M");
  Settings settings_ = ascii(model_);
  EmulatedModule module_{model_, &settings_};
};

TEST_F(HungImage, IsResetWhereTheMainLoopHangsAndInterruptsGoOn) {
  // What the interrupt returns to becomes a jump to itself; then the image's own interrupt follows, and from
  // the next one on it is that alone.
  make_tick_run({
      0x21004805,  // ldr r0, =kVectorTableOffset; movs r1, #0
      0xA0026001,  // str r1, [r0]; adr r0, loop
      0x4A049006,  // str r0, [sp, #24]; ldr r2, =its own interrupt
      0x46C04710,  // bx r2; nop
      0x46C0E7FE,  // loop: b loop; nop
      0,
      kVectorTableOffset,
      bus().read(4 * kSysTickVector),
  });
  expect_reset_because("WATCHDOG");
}

TEST_F(HungImage, IsResetWhereItHangsInAnInterrupt) {
  make_tick_run({0xE7FEE7FE});  // b .
  expect_reset_because("WATCHDOG");
}

TEST_F(HungImage, IsResetWhereTheTickStops) {
  bus().write(kSysTickControl, 0);
  expect_reset_because("WATCHDOG");
}

TEST_F(HungImage, ResetsItselfAtAnInterruptThatNobodyHasAskedFor) {
  constexpr std::uint32_t kPend = 0xE000'E200;
  constexpr std::uint32_t kEnable = 0xE000'E100;
  constexpr std::uint32_t kSsi0 = 1U << 7U;
  bus().write(kEnable, kSsi0);
  bus().write(kPend, kSsi0);
  expect_reset_because("SHUTDOWN");
}

TEST_F(HungImage, AnswersAfterAFloodOfBytes) {
  const std::vector<std::uint8_t> noise(4096, 'U');
  for (unsigned i = 0; i < 16; ++i) {
    module_.send(noise);
  }
  // Whatever is still in the socket comes before.
  EXPECT_EQ(ask(module_, "\r$015", std::chrono::seconds(20)).substr(0, 3), "!01");
  EXPECT_EQ(ask(module_, "@01"), module_.outputs() == 0x1FFF ? ">1FFF" : ">0A05");
}

TEST(ImageInAnInterruptStorm, IsResetAndComesBackWhenItIsOver) {
  // Input 0 is PB0. That its level interrupts, and not its edges, is what makes the storm: no handler can end
  // it.
  const std::string kPortB = "/machine/unattached/device[9]";
  constexpr std::uint32_t kSense = 0x4000'5404;
  constexpr std::uint32_t kBothEdges = 0x4000'5408;
  constexpr std::uint32_t kHighLevel = 0x4000'540C;
  constexpr std::uint32_t kInput0 = 1;
  const Model& model = *find_model("EX9052D");
  EmulatedModule module(model, nullptr);
  module.power(true);
  wait_until_up(module);
  EXPECT_EQ(ask(module, "$015"), "!011");
  EXPECT_EQ(ask(module, "$015"), "!010");
  QtestClient& bus = module.emulator().bus();
  bus.write(kBothEdges, 0);
  bus.write(kHighLevel, kInput0);
  bus.write(kSense, kInput0);
  bus.set_input(kPortB, 0, true);
  ASSERT_TRUE(module.halts_because("WATCHDOG"));
  module.come_up_again();
  wait_until_up(module);
  EXPECT_EQ(ask(module, "$015"), "!011");
  module.set_input(0, true);
  EXPECT_EQ(ask(module, "@01"), ">0100");
}

}  // namespace
}  // namespace ex9000::rig
