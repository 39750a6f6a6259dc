// Tests the module watchdog of an image (wire.md section 6). The watchdog must reset the module during any
// activity if the image hangs, if the tick stops, or if an interrupt occurs continuously. Also tests that a
// stuck EEPROM bus causes no reset.
#include <gtest/gtest.h>

#include <cstdio>
#include <string>
#include <vector>

#include "tests/boards/images_under_test.hpp"
#include "tests/boards/watched_module.hpp"
#include "tests/mcu_model/board_bench.hpp"

namespace ex9000::registers {
namespace {

using Bytes = std::vector<std::uint8_t>;
using std::chrono::milliseconds;
using std::chrono::seconds;

constexpr milliseconds kResetsWithin{1600};

class FaultOnBoard : public WatchedImage {
 protected:
  template <class Fault>
  void expect_reset(const std::string& what, Fault fault) {
    for (const bool timeout_status : {false, true}) {
      for (const Doing doing : kEverything) {
        SCOPED_TRACE(what + " while " + name_of(doing) + (timeout_status ? ", timeout status set" : ""));
        Settings settings = set_up(*find_model(image().model), protocol());
        settings.timeout_status = timeout_status;
        WatchedModule module(image(), settings);
        BoardBench& bench = module.bench;
        ASSERT_TRUE(module.was_reset());
        ASSERT_FALSE(module.was_reset());
        if (bench.image.outputs != 0) {
          ASSERT_EQ(module.drive(kDriven), !timeout_status);
        }
        const std::uint16_t before = bench.outputs();
        make_it(module, doing);
        fault(bench);
        module.changes.clear();
        bench.run_for(kResetsWithin);
        ASSERT_EQ(bench.watchdog_resets, 1U);
        ASSERT_EQ(bench.resets, 1U);
        bench.run_for(kComesUpWithin);
        const std::uint16_t after = bench.image.outputs == 0 ? 0
                                    : timeout_status         ? kSafeValue
                                                             : kPowerOnValue;
        EXPECT_EQ(bench.outputs(), after);
        for (const WatchedModule::Change& change : module.changes) {
          // A reset switches all outputs off. Then the module drives the outputs to the power-on value or to
          // the safe value, one group of pins after the other. The model reports each pin separately.
          EXPECT_EQ(change.at <= bench.began ? change.outputs & ~before : change.outputs & ~after, 0);
        }
        EXPECT_TRUE(module.was_reset());
        EXPECT_FALSE(module.was_reset());
        const Bytes reason = module.ask("~01X0301", {1, 0x04, 0x03, 0x01, 0, 1});
        EXPECT_EQ(reason, module.framed("!010002", {1, 0x04, 2, 0, 2}));
        EXPECT_EQ(module.timeout_status(), timeout_status);
        EXPECT_TRUE(module.enabled());
        EXPECT_TRUE(module.stores_a_timeout(0x40));
        ASSERT_FALSE(HasFailure());
        ++resets_;
      }
    }
  }

  void TearDown() override {
    if (resets_ != 0) {
      std::printf("%s: %u resets\n", testing::UnitTest::GetInstance()->current_test_info()->name(), resets_);
    }
  }

  unsigned resets_ = 0;
};

TEST_P(FaultOnBoard, AHungMainLoopCausesAReset) {
  expect_reset("the main loop hangs", [](BoardBench& bench) { bench.mcu->hang(Hangs::MainLoop); });
}

// wire.md 2: a crash loop. RAM keeps the count through a reset.
TEST_P(FaultOnBoard, TheThirdResetInARowLeadsToTheSafeValue) {
  WatchedModule module(image(), set_up(*find_model(image().model), protocol()));
  BoardBench& bench = module.bench;
  const auto expect = [&](std::uint16_t outputs) {
    bench.run_for(kComesUpWithin);
    EXPECT_EQ(bench.outputs(), bench.image.outputs == 0 ? 0 : outputs);
  };
  for (const std::uint16_t outputs : {kPowerOnValue, kPowerOnValue, kSafeValue, kSafeValue}) {
    bench.mcu->hang(Hangs::MainLoop);
    bench.run_for(kResetsWithin);
    expect(outputs);
  }
  bench.reset();
  expect(kPowerOnValue);
}

TEST_P(FaultOnBoard, AHungInterruptHandlerCausesAReset) {
  expect_reset("an interrupt hangs", [](BoardBench& bench) {
    bench.mcu->hang(Hangs::Handler);
    // The hang begins at a register access. The handler of this interrupt, I2C0, accesses a register.
    bench.mcu->core.stick(8);
  });
}

TEST_P(FaultOnBoard, AStoppedTickCausesAReset) {
  expect_reset("the tick stops", [](BoardBench& bench) {
    bench.mcu->core.write(Core::kTickControl, 4);
    // The module's clock stops, so the wake timer expires repeatedly. Long accesses make the simulation
    // faster.
    bench.mcu->set_clocks_an_access(1000);
  });
}

// The driver would jam the line for ever. The deadline of a reply is its length and 100 ms.
TEST_P(FaultOnBoard, ALostEndOfAReplyCausesAReset) {
  constexpr unsigned kUarts[] = {5, 6};
  constexpr unsigned kLineEndTimer = 21;  // timer 1A
  for (const bool ends : {false, true}) {
    WatchedModule module(image(), set_up(*find_model(image().model), protocol()));
    BoardBench& bench = module.bench;
    const unsigned lost = ends ? kLineEndTimer : kUarts[bench.image.uart];
    const Bytes request = module.framed("$012", {1, 0x11});
    const auto driver_is_on = [&bench] { return bench.line.driven(); };
    const Bytes reply = bench.exchange(request);
    bench.line.send(request);
    ASSERT_TRUE(runs_until(bench, driver_is_on, std::chrono::microseconds(100)));
    bench.mcu->core.lose(lost);
    const Instant length = static_cast<std::int64_t>(reply.size()) * bench.line.character_time();
    bench.run_for(length + milliseconds(50));
    ASSERT_TRUE(driver_is_on());
    bench.run_for(milliseconds(60) + kResetsWithin);
    EXPECT_EQ(bench.watchdog_resets, 1U);
    EXPECT_FALSE(driver_is_on());
    bench.run_for(kComesUpWithin);
    EXPECT_EQ(bench.exchange(request), reply);
  }
}

TEST_P(FaultOnBoard, AnInterruptStormCausesAReset) {
  WatchedModule module(image(), set_up(*find_model(image().model), protocol()));
  const std::uint32_t enabled = module.bench.mcu->core.enabled();
  ASSERT_NE(enabled, 0U);
  for (unsigned interrupt = 0; interrupt < 32; ++interrupt) {
    if ((enabled >> interrupt & 1U) != 0) {
      const std::string what = "interrupt " + std::to_string(interrupt) + " occurs continuously";
      expect_reset(what, [interrupt](BoardBench& stormy) {
        stormy.mcu->core.stick(interrupt);
        stormy.mcu->set_clocks_an_access(1000);  // a storm would otherwise take millions of accesses
      });
    }
  }
}

TEST_P(FaultOnBoard, AStuckEepromBusCausesRefusedStoresButNoReset) {
  for (const unsigned line : {I2cBlock::kClockPin, I2cBlock::kDataPin}) {
    for (const Doing doing : kEverything) {
      SCOPED_TRACE(std::string(line == I2cBlock::kClockPin ? "the clock line" : "the data line") +
                   " is stuck while " + name_of(doing));
      WatchedModule module(image(), set_up(*find_model(image().model), protocol()));
      BoardBench& bench = module.bench;
      if (bench.image.outputs != 0) {
        ASSERT_TRUE(module.drive(kDriven));
      }
      const std::uint16_t outputs = bench.outputs();
      ASSERT_TRUE(module.stores_a_timeout(0xC8));
      bench.line.heard.clear();
      make_it(module, doing);
      Net& wire = bench.pins.at('B', line);
      wire.drive(End::Fault, Drive::Low);
      module.changes.clear();
      bench.run_for(seconds(2));
      if (doing == Doing::OnTheEepromsBus || doing == Doing::Programming) {
        // The module refuses the command, because it can neither write to the EEPROM nor read from it.
        ASSERT_GE(bench.line.heard.size(), 3U);
        EXPECT_TRUE(module.ascii() ? bench.line.heard[0].byte == '?' : bench.line.heard[1].byte == 0x86U);
      }
      if (doing == Doing::Receiving) {
        module.ask("", {});  // in ASCII, the CR of this request ends the incomplete request
      }
      EXPECT_FALSE(module.stores_a_timeout(0x40));
      if (bench.image.outputs != 0) {
        EXPECT_TRUE(module.drive(outputs));
      }
      EXPECT_FALSE(module.timeout_status());
      EXPECT_EQ(bench.resets, 0U);
      EXPECT_TRUE(module.changes.empty());
      wire.drive(End::Fault, Drive::Nothing);
      bench.run_for(seconds(3));
      EXPECT_TRUE(module.stores_a_timeout(0x40));
      module.power_cycle();
      const Bytes reply = module.ask("~012", {1, 0x03, 0x01, 0xE8, 0, 1});
      EXPECT_EQ(reply, module.framed("!01140", {1, 0x03, 2, 0, 0x40}));
      ASSERT_FALSE(HasFailure());
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Images, FaultOnBoard,
                         testing::Combine(testing::Values(ImageName{"ek-tm4c123gxl", "EX9043D-M"},
                                                          ImageName{"ek-tm4c123gxl", "EX9052D-M"}),
                                          kBothProtocols),
                         name_of_watched_image);

}  // namespace
}  // namespace ex9000::registers
