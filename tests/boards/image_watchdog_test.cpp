// Tests that the hardware watchdog resets an image if the image hangs, if the tick stops, or during an
// interrupt storm. Also tests that the image resets itself on an unexpected interrupt, and that a blocked
// EEPROM bus and bytes without a gap cause no reset. The image itself is not changed. If a fault requires
// code, this code is in RAM that the image does not use, and a copy of the vector table in RAM points to this
// code. After a reset, the copy points to the image's own handlers again.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/qemu/master.hpp"
#include "tests/qemu/signals.hpp"
#include "tests/qemu/timed_module.hpp"
#include "tests/support/either_protocol.hpp"
#include "tests/support/environment.hpp"

namespace ex9000::rig {
namespace {

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
enum class Doing : std::uint8_t { Nothing, Receiving, Answering, Storing };
constexpr Doing kEverything[] = {Doing::Nothing, Doing::Receiving, Doing::Answering, Doing::Storing};

class FaultyImage : public testing::TestWithParam<Protocol>, protected EitherProtocol {
 protected:
  FaultyImage() : EitherProtocol(GetParam(), [this](const Bytes& frame) { return exchange(frame); }) {}

  using Fault = void (FaultyImage::*)();

  static constexpr std::uint16_t kPowerOnValue = 0x5A5A;
  static constexpr std::uint16_t kSafeValue = 0xA5A4;

  QtestClient& bus() { return module_.emulator().bus(); }

  Bytes exchange(const Bytes& frame) {
    constexpr milliseconds kSilence{5};
    module_.run_for(kSilence);
    module_.hear(module_.mode());
    module_.send(frame, module_.mode());
    module_.run_for(3 * kSilence);
    return module_.hear(module_.mode());
  }
  bool stores() {
    const Bytes reply = ask("~01OVALVE", {1, 0x06, 0x01, 0xE8, 0, 0x40});
    return ascii() ? reply.at(0) == '!' : reply.at(1) == 0x06;
  }

  void begin(bool status) {
    Settings settings = Settings::factory(model_);
    settings.protocol = GetParam();
    settings.power_on_value = kPowerOnValue;
    settings.safe_value = kSafeValue;
    settings.timeout_status = status;
    module_.begin_anew(&settings);
    module_.run_for(kComesUpWithin);
    ASSERT_TRUE(was_reset());
    ASSERT_FALSE(was_reset());
    if (!status) {
      ask("@01C35A", {1, 0x0F, 0, 0, 0, 16, 2, 0x5A, 0xC3});
      ASSERT_EQ(module_.outputs(), 0xC35A);
    }
  }

  void make_it(Doing doing) {
    const Bytes harmless = framed("$01M", {1, 0x11});
    constexpr int kLooks = 1000;
    switch (doing) {
      case Doing::Nothing:
        break;
      case Doing::Receiving:
        module_.send({harmless.begin(), harmless.begin() + 2}, module_.mode());
        break;
      case Doing::Answering:
        module_.send(harmless, module_.mode());
        for (int i = 0; i < kLooks && !level_of(bus(), board::kDriverEnable); ++i) {
          module_.run_for(std::chrono::microseconds(13));
        }
        ASSERT_TRUE(level_of(bus(), board::kDriverEnable));
        break;
      case Doing::Storing:
        // The emulated EEPROM stores immediately. Therefore the test disables the I2C interrupt. It enables
        // the interrupt again when the image has received the request and is waiting for the end of a byte on
        // the bus of the EEPROM.
        module_.send(framed("~01OPUMP", {1, 0x06, 0x01, 0xE8, 0, 0x41}), module_.mode());
        bus().write(kClearEnable, 1U << kI2c0);
        module_.run_for(std::chrono::microseconds(ascii() ? 2500 : 5500));
        bus().write(kSetEnable, 1U << kI2c0);
        break;
    }
  }

 public:
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
  void hang_interrupt() { make_interrupt_run(kSysTickVector, {0xE7FEE7FE}); }  // b .
  void stop_tick() { bus().write(kSysTickControl, 0); }
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
  /// Hides the end of every byte on the EEPROM's bus from the image.
  void wedge_bus() {
    constexpr std::uint32_t kInterruptClear = 0x4002'001C;
    make_interrupt_run(kI2c0Vector, {
                                        0x21014801,  // ldr r0, =kInterruptClear; movs r1, #1
                                        0x47706001,  // str r1, [r0]; bx lr
                                        kInterruptClear,
                                    });
  }

 protected:
  /// Waits until the watchdog resets the module. Also checks the load register of the watchdog, because the
  /// time until the reset cannot be observed in all cases.
  void expect_reset_in_time() {
    constexpr std::uint32_t kWatchdogLoad = 0x4000'0000;
    constexpr std::uint32_t kCountdowns = 2;
    EXPECT_LE(std::uint64_t{bus().read(kWatchdogLoad)} * kCountdowns,
              std::uint64_t{kWatchdogPeriod.count()} * board::kClock.frequency() / 1000);
    module_.run_to_reset("WATCHDOG", kWatchdogPeriod);
  }

  /// Returns whether the test runs this case without EX9000_CUTS=all. In ASCII, the test runs each value of
  /// the timeout status with half of the activities. In Modbus, the test runs only Storing with a clear
  /// timeout status. The test runs only one storm, because the emulator requires seconds for a storm.
  [[nodiscard]] bool belongs_to_short_form(Doing doing, bool status, Fault fault) const {
    const bool first_half = doing == Doing::Nothing || doing == Doing::Storing;
    if (fault == &FaultyImage::storm) {
      return ascii() && status && doing == Doing::Receiving;
    }
    return status != first_half && (ascii() || doing == Doing::Storing);
  }

  void expect_resets(const char* what, Fault fault) {
    for (const Doing doing : kEverything) {
      for (const bool status : {false, true}) {
        if (!all_cases_requested() && !belongs_to_short_form(doing, status, fault)) {
          continue;
        }
        SCOPED_TRACE(std::string(what) + ", activity " + std::to_string(static_cast<int>(doing)) +
                     (status ? ", timeout status set" : ""));
        begin(status);
        make_it(doing);
        ASSERT_FALSE(HasFailure());
        (this->*fault)();
        expect_reset_in_time();
        ASSERT_FALSE(HasFailure());
        module_.reset();
        module_.run_for(kComesUpWithin);
        EXPECT_EQ(module_.outputs(), status ? kSafeValue : kPowerOnValue);
        EXPECT_TRUE(was_reset());
        EXPECT_FALSE(was_reset());
        EXPECT_EQ(timeout_status(), status);
        EXPECT_TRUE(stores());
        ASSERT_FALSE(HasFailure());
      }
    }
  }

  const Model& model_ = *find_model("EX9043D-M");
  TimedModule module_{model_};
};

TEST_P(FaultyImage, IsResetIfTheMainLoopHangsAndInterruptsContinue) {
  expect_resets("the main loop hangs", &FaultyImage::hang_main_loop);
}

TEST_P(FaultyImage, IsResetIfItHangsInAnInterrupt) {
  expect_resets("an interrupt hangs", &FaultyImage::hang_interrupt);
}

TEST_P(FaultyImage, IsResetIfTheTickStops) { expect_resets("the tick stops", &FaultyImage::stop_tick); }

TEST_P(FaultyImage, IsResetDuringAnInterruptStorm) {
  expect_resets("an interrupt occurs continuously", &FaultyImage::storm);
}

TEST_P(FaultyImage, RunsWhileTheEepromBusIsBlockedAndStoresWhenTheBusIsFreeAgain) {
  for (const Doing doing : kEverything) {
    SCOPED_TRACE(static_cast<int>(doing));
    begin(false);
    make_it(doing);
    const std::uint32_t entry = bus().read(kVectorTableOffset) + 4 * kI2c0Vector;
    const std::uint32_t own = bus().read(entry);
    wedge_bus();
    module_.run_for(std::chrono::seconds(3));
    EXPECT_EQ(module_.outputs(), 0xC35A);
    if (doing == Doing::Receiving) {
      ask("", {});
    }
    module_.hear(module_.mode());
    module_.send(framed("~01OVALVE", {1, 0x06, 0x01, 0xE8, 0, 0x42}), module_.mode());
    module_.run_for(milliseconds(200));
    const Bytes reply = module_.hear(module_.mode());
    ASSERT_GE(reply.size(), 3U);
    EXPECT_TRUE(ascii() ? reply[0] == '?' : reply[1] == 0x86U);
    EXPECT_FALSE(timeout_status());
    EXPECT_FALSE(was_reset());
    bus().write(entry, own);
    module_.run_for(std::chrono::seconds(2));  // the module invalidates refused copies
    EXPECT_TRUE(stores());
    ASSERT_FALSE(HasFailure());
  }
}

std::string name_of(const testing::TestParamInfo<Protocol>& protocol) {
  return protocol.param == Protocol::Ascii ? "ASCII" : "Modbus";
}
INSTANTIATE_TEST_SUITE_P(Speaking, FaultyImage, testing::Values(Protocol::Ascii, Protocol::ModbusRtu),
                         name_of);

class HungImage : public testing::Test {
 protected:
  HungImage() {
    module_.begin_anew(&settings_);
    module_.run_for(kComesUpWithin);
    EXPECT_EQ(ask(module_, "@010A05"), ">");
    EXPECT_EQ(ask(module_, "~015P"), "!01");
    EXPECT_EQ(ask(module_, "@011FFF"), ">");
    EXPECT_EQ(ask(module_, "$015"), "!011");
    EXPECT_EQ(ask(module_, "$015"), "!010");
    EXPECT_EQ(module_.outputs(), 0x1FFF);
  }

  QtestClient& bus() { return module_.emulator().bus(); }

  /// The limit of 10 ms is much shorter than the period of the watchdog. Therefore only the image itself can
  /// cause this reset.
  void expect_reset_by_the_image() {
    module_.run_to_reset("SHUTDOWN", milliseconds(10));
    module_.reset();
    module_.run_for(kComesUpWithin);
    EXPECT_EQ(ask(module_, "$015"), "!011");
    EXPECT_EQ(module_.outputs(), 0x0A05);
    EXPECT_EQ(ask(module_, "@01"), ">0A05");
    EXPECT_EQ(ask(module_, "$015"), "!010");
  }

  const Model& model_ = *find_model("EX9042D-M");
  Settings settings_ = ascii(model_);
  TimedModule module_{model_};
};

TEST_F(HungImage, ResetsItselfOnAnUnexpectedInterrupt) {
  constexpr std::uint32_t kPend = 0xE000'E200;
  constexpr std::uint32_t kEnable = 0xE000'E100;
  constexpr std::uint32_t kSsi0 = 1U << 7U;
  bus().write(kEnable, kSsi0);
  bus().write(kPend, kSsi0);
  expect_reset_by_the_image();
}

/// At the highest baud rate, the bytes follow each other without a gap for more than three periods of the
/// watchdog.
TEST_F(HungImage, RepliesAfter65536BytesWithoutAGap) {
  constexpr std::uint8_t kFastest = 0x0A;  // 115200 baud
  settings_.baud_code = kFastest;
  module_.begin_anew(&settings_);
  module_.run_for(kComesUpWithin);
  EXPECT_EQ(ask(module_, "@011FFF"), ">");
  EXPECT_EQ(ask(module_, "$015"), "!011");
  module_.send(TimedModule::Bytes(65536, 'U'), module_.mode());
  EXPECT_EQ(ask(module_, "$015"), "!010");
  EXPECT_EQ(ask(module_, "@01"), ">1FFF");
  EXPECT_EQ(module_.outputs(), 0x1FFF);
}

TEST(ImageInAnInterruptStorm, IsResetAndWorksAfterTheStormHasEnded) {
  // Input 0 is PB0. The test sets the interrupt of PB0 to trigger on a high level instead of on edges. No
  // handler can end this interrupt while the pin is high.
  const std::string kPortB = "/machine/unattached/device[9]";
  constexpr std::uint32_t kSense = 0x4000'5404;
  constexpr std::uint32_t kBothEdges = 0x4000'5408;
  constexpr std::uint32_t kHighLevel = 0x4000'540C;
  constexpr std::uint32_t kInput0 = 1;
  const Model& model = *find_model("EX9052D");
  TimedModule module(model);
  module.power(true);
  module.run_for(kComesUpWithin);
  EXPECT_EQ(ask(module, "$015"), "!011");
  EXPECT_EQ(ask(module, "$015"), "!010");
  QtestClient& bus = module.emulator().bus();
  bus.write(kBothEdges, 0);
  bus.write(kHighLevel, kInput0);
  bus.write(kSense, kInput0);
  bus.set_input(kPortB, 0, true);
  module.run_to_reset("WATCHDOG", kWatchdogPeriod);
  module.reset();
  module.run_for(kComesUpWithin);
  EXPECT_EQ(ask(module, "$015"), "!011");
  module.set_input(0, true);
  EXPECT_EQ(ask(module, "@01"), ">0100");
}

}  // namespace
}  // namespace ex9000::rig
