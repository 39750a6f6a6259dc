// Tests the shipped bits of an image in QEMU with faults: power cuts, hangs, an interrupt storm, an
// unexpected interrupt, a blocked EEPROM bus, and bytes without a gap. Also compares the stack that the image
// uses with the worst case of check-image. power_cuts_test and image_module_watchdog_driver_test test the
// same faults at every register access, on register models.
//
// The image itself is not changed. If a fault requires code, this code is in RAM that the image does not use,
// and a copy of the vector table in RAM points to this code. After a reset, the copy points to the image's
// own handlers again.
#include <gtest/gtest.h>

#include <algorithm>
#include <regex>
#include <string>
#include <vector>

#include "tests/qemu/master.hpp"
#include "tests/qemu/signals.hpp"
#include "tests/qemu/timed_module.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/in_repository.hpp"

namespace ex9000::rig {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

/// The longest period of the module's watchdog: wire.md section 6.
constexpr milliseconds kWatchdogPeriod{1600};

constexpr std::uint32_t kSysTickControl = 0xE000'E010;
constexpr std::uint32_t kVectorTableOffset = 0xE000'ED08;
constexpr std::uint32_t kSetEnable = 0xE000'E100;
constexpr std::uint32_t kClearEnable = 0xE000'E180;
constexpr std::uint32_t kSetPending = 0xE000'E200;
constexpr std::uint32_t kSysTickVector = 15;
constexpr std::uint32_t kI2c0 = 8;
constexpr std::uint32_t kI2c0Vector = 16 + kI2c0;
/// The address of the code that causes a fault. It is above the RAM that the image and the test bench use,
/// and below the image's stack at the top of RAM.
constexpr std::uint32_t kCode = 0x2000'C000;
constexpr std::uint32_t kThumb = 1;

/// The activity of an image when a fault begins.
enum class Doing : std::uint8_t { Receiving, Storing };

class FaultyImage : public testing::Test {
 protected:
  static constexpr std::uint16_t kPowerOnValue = 0x5A5A;

  FaultyImage() {
    Settings settings = ascii(model_);
    settings.power_on_value = kPowerOnValue;
    begin(settings);
    EXPECT_EQ(ask(module_, "$015"), "!011");
  }

  void begin(const Settings& settings) {
    module_.begin_anew(&settings);
    module_.run_for(kComesUpWithin);
  }
  QtestClient& bus() { return module_.emulator().bus(); }

  void make_it(Doing doing) {
    EXPECT_EQ(ask(module_, "@01C35A"), ">");
    EXPECT_EQ(ask(module_, "$015"), "!010");
    const std::string request = doing == Doing::Receiving ? "$0" : "~01OPUMP\r";
    module_.send({request.begin(), request.end()}, module_.mode());
    if (doing == Doing::Storing) {
      // The emulated EEPROM stores immediately. Therefore the test disables the I2C interrupt while the image
      // waits for the end of a byte on the bus of the EEPROM.
      bus().write(kClearEnable, 1U << kI2c0);
      module_.run_for(microseconds(2500));
      bus().write(kSetEnable, 1U << kI2c0);
    }
  }

  // --- faults ---

  /// `make_interrupt_run` installs `code` as the handler of an interrupt. In `code`, it replaces kEntry with
  /// the address of the interrupt's entry in the vector table, and kOwn with the address of the image's own
  /// handler.
  static constexpr std::uint32_t kEntry = 0xE1E1'E1E1;
  static constexpr std::uint32_t kOwn = 0xE2E2'E2E2;
  void make_interrupt_run(std::uint32_t vector, const std::vector<std::uint32_t>& code) {
    const std::uint32_t entry = bus().read(kVectorTableOffset) + 4 * vector;
    const std::uint32_t own = bus().read(entry);
    std::uint32_t at = kCode;
    for (const std::uint32_t word : code) {
      bus().write(at, word == kEntry ? entry : word == kOwn ? own : word);
      at += 4;
    }
    bus().write(entry, kCode | kThumb);
  }

  void hang_main_loop() {
    // At the next tick, this code restores the entry of the vector table, replaces the return address of the
    // interrupt with the address of an endless loop, and jumps to the image's own handler. After that,
    // interrupts run, but the main loop does not.
    make_interrupt_run(kSysTickVector, {
                                           0x4A044803,  // ldr r0, =entry; ldr r2, =own
                                           0xA0016002,  // str r2, [r0]; adr r0, loop
                                           0x47109006,  // str r0, [sp, #24]; bx r2
                                           0x46C0E7FE,  // loop: b loop; nop
                                           kEntry,
                                           kOwn,
                                       });
  }
  /// Starts an interrupt storm: the handler of I2C0 requests its interrupt again each time, and then does its
  /// normal work.
  void storm() {
    make_interrupt_run(kI2c0Vector, {
                                        0x21014803,  // ldr r0, =kSetPending; movs r1, #1
                                        0x60010209,  // lsls r1, r1, #8; str r1, [r0]
                                        0x47004802,  // ldr r0, =own; bx r0
                                        0x46C046C0,  // nop; nop
                                        kSetPending,
                                        kOwn,
                                    });
    bus().write(kSetPending, 1U << kI2c0);
  }

  /// Waits until the emulator is about to reset the machine, and checks the module after the reset.
  void expect_reset(const char* event, milliseconds within) {
    module_.run_to_reset(event, within);
    module_.reset();
    module_.run_for(kComesUpWithin);
    EXPECT_EQ(module_.outputs(), kPowerOnValue);
    EXPECT_EQ(ask(module_, "$015"), "!011");
    EXPECT_EQ(ask(module_, "$015"), "!010");
    EXPECT_EQ(ask(module_, "~01OVALVE"), "!01");
  }

  const Model& model_ = *find_model("EX9043D-M");
  TimedModule module_{model_};
};

TEST_F(FaultyImage, HasOldOrNewSettingsAfterAPowerCutDuringAStore) {
  constexpr microseconds kTurnAround{940};  // after it, the image stores
  unsigned olds = 0;
  unsigned news = 0;
  for (int step = 0; step < 40; ++step) {
    EXPECT_EQ(ask(module_, "~01OOLD"), "!01");
    const std::string command = "~01ONEW\r";
    module_.send({command.begin(), command.end()}, module_.mode());
    module_.run_for(kTurnAround + microseconds(15) * step);
    module_.kill();  // a new process starts from the same EEPROM file
    EXPECT_EQ(module_.outputs(), 0);
    module_.power(true);
    module_.run_for(kComesUpWithin);
    EXPECT_EQ(module_.outputs(), kPowerOnValue);
    const std::string name = ask(module_, "$01M");
    ASSERT_TRUE(name == "!01OLD" || name == "!01NEW") << step << ": " << name;
    (name == "!01OLD" ? olds : news) += 1;
  }
  EXPECT_GT(olds, 5U);
  EXPECT_GT(news, 5U);
}

TEST_F(FaultyImage, IsResetByTheWatchdogIfItHangsOrTheTickStops) {
  for (const Doing doing : {Doing::Receiving, Doing::Storing}) {
    SCOPED_TRACE(static_cast<int>(doing));
    make_it(doing);
    hang_main_loop();
    expect_reset("WATCHDOG", kWatchdogPeriod);
    make_it(doing);
    make_interrupt_run(kSysTickVector, {0xE7FEE7FE});  // b .
    expect_reset("WATCHDOG", kWatchdogPeriod);
    make_it(doing);
    bus().write(kSysTickControl, 0);
    expect_reset("WATCHDOG", kWatchdogPeriod);
  }
}

TEST_F(FaultyImage, IsResetByTheWatchdogDuringAnInterruptStorm) {
  make_it(Doing::Receiving);
  storm();
  expect_reset("WATCHDOG", kWatchdogPeriod);
}

/// The limit of 10 ms is much shorter than the period of the watchdog. Therefore only the image itself can
/// cause this reset.
TEST_F(FaultyImage, ResetsItselfOnAnUnexpectedInterrupt) {
  constexpr std::uint32_t kSsi0 = 1U << 7U;
  make_it(Doing::Receiving);
  bus().write(kSetEnable, kSsi0);
  bus().write(kSetPending, kSsi0);
  expect_reset("SHUTDOWN", milliseconds(10));
}

TEST_F(FaultyImage, RunsWhileTheEepromBusIsBlockedAndStoresWhenTheBusIsFreeAgain) {
  make_it(Doing::Storing);
  const std::uint32_t entry = bus().read(kVectorTableOffset) + 4 * kI2c0Vector;
  const std::uint32_t own = bus().read(entry);
  // Hides the end of every byte on the EEPROM's bus from the image.
  constexpr std::uint32_t kInterruptClear = 0x4002'001C;
  make_interrupt_run(kI2c0Vector, {
                                      0x21014801,  // ldr r0, =kInterruptClear; movs r1, #1
                                      0x47706001,  // str r1, [r0]; bx lr
                                      kInterruptClear,
                                  });
  module_.run_for(std::chrono::seconds(3));
  EXPECT_EQ(ask(module_, "~01OVALVE"), "?01");
  EXPECT_EQ(module_.outputs(), 0xC35A);
  EXPECT_EQ(ask(module_, "$015"), "!010");
  bus().write(entry, own);
  module_.run_for(std::chrono::seconds(2));  // the module invalidates refused copies
  EXPECT_EQ(ask(module_, "~01OVALVE"), "!01");
}

/// At the highest baud rate, the bytes follow each other without a gap for more than three periods of the
/// watchdog.
TEST_F(FaultyImage, RepliesAfter65536BytesWithoutAGap) {
  Settings settings = ascii(model_);
  settings.baud_code = 0x0A;  // 115200 baud
  begin(settings);
  EXPECT_EQ(ask(module_, "@011FFF"), ">");
  EXPECT_EQ(ask(module_, "$015"), "!011");
  module_.send(TimedModule::Bytes(65536, 'U'), module_.mode());
  ask(module_, "");
  EXPECT_EQ(ask(module_, "$015"), "!010");
  EXPECT_EQ(module_.outputs(), 0x1FFF);
}

/// EmulatedBoard fills RAM with the byte 0xA5 before a start.
TEST_F(FaultyImage, UsesAtMostTheStackThatCheckImageComputes) {
  constexpr std::uint32_t kTopOfRam = 0x2001'0000;
  constexpr std::uint32_t kLooked = 0x800;
  make_it(Doing::Storing);
  module_.run_for(milliseconds(200));
  EXPECT_EQ(ask(module_, "~0131FF"), "!01");
  const TimedModule::Bytes ram = bus().read(kTopOfRam - kLooked, kLooked);
  const auto untouched = std::find_if(ram.begin(), ram.end(), [](std::uint8_t byte) { return byte != 0xA5; });
  const auto used = static_cast<unsigned long>(ram.end() - untouched);
  const std::string image = image_of(model_);
  const std::string unit = EX9000_IMAGES "/boards/CMakeFiles/EX9043D-M.dir/Unity/unity_0_cxx.cxx.obj";
  const system::Finished checked =
      system::run({in_repository("toolchain/check-image"), image, in_repository(unit)});
  std::smatch worst;
  ASSERT_TRUE(std::regex_search(checked.output, worst, std::regex(R"((\d+) stack at worst)")))
      << checked.error;
  EXPECT_LE(used, std::stoul(worst[1]));
  EXPECT_GT(used, std::stoul(worst[1]) / 4) << "the activities use too little of the stack";
  std::printf("stack: %lu bytes used, %s at worst\n", used, worst[1].str().c_str());
}

}  // namespace
}  // namespace ex9000::rig
