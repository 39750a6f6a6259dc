// Tests the EEPROM driver together with the I2C driver, bit by bit on two wires, with faults of the EEPROM
// and of the wires.
#include <gtest/gtest.h>

#include <algorithm>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "hal/at24c/at24c.hpp"
#include "hal/stellaris/i2c.hpp"
#include "tests/mcu_model/driver_bench.hpp"
#include "tests/mcu_model/eeprom_chip.hpp"

namespace ex9000::registers {
namespace {

using hal::stellaris::Family;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr std::uint32_t kHertz = 50'000'000;

/// The longest permitted time of a job. It allows for two pages that take 10 ms each to program, for the
/// transfer of their bytes, and for the time to free the bus.
constexpr milliseconds kLongestJob{40};
/// The greatest permitted number of register accesses in a turn of the main loop.
constexpr std::uint64_t kMostAccessesATurn = 24;

/// The driver and a main loop. The main loop makes a turn after each interrupt. Without an interrupt, it
/// makes the next turn 1 ms after a turn, or 2 us after a turn in which the driver has requested another
/// turn.
template <Family family>
class Bench {
 public:
  using Driver = hal::At24c<hal::stellaris::I2c<family, kHertz>>;

  explicit Bench(I2cBehaviour behaviour) : behaviour_(behaviour), memory(EepromChip::kSize, 0xFF) {
    wires.emplace();
    eeprom.emplace(wires->timeline, wires->pins.at('B', 2), wires->pins.at('B', 3), memory);
    Net& clock = clock_net();
    Net& data = data_net();
    clock.on_change([this, &clock] { clocks += clock.level() ? 1U : 0U; });
    data.on_change([this, &clock, &data] {
      if (!clock.level()) {
        return;
      }
      if (data.level()) {
        ++stops;
      } else if (starts++ == 0) {
        clocks_before_start = clocks;
      }
    });
    begin();
  }

  /// Resets the microcontroller but not the EEPROM.
  void reset() {
    mcu.reset();
    begin();
  }

  bool read(std::uint16_t address, std::vector<std::uint8_t>& into) {
    driver->start_read(address, {into.data(), into.size()}, now());
    return finish();
  }
  bool write(std::uint16_t address, const std::vector<std::uint8_t>& bytes) {
    driver->start_write(address, {bytes.data(), bytes.size()}, now());
    return finish();
  }
  /// Runs until the job is over, but for at most about kLongestJob. Returns whether the job succeeded. If the
  /// job is not over by then, fails the test and returns false.
  bool finish() {
    const Instant patience = wires->timeline.now() + kLongestJob;
    while (driver->busy() && wires->timeline.now() < patience) {
      turn();
    }
    EXPECT_FALSE(driver->busy()) << "the job does not finish";
    return !driver->busy() && driver->succeeded();
  }
  void run_for(Instant time) {
    const Instant end = wires->timeline.now() + time;
    while (wires->timeline.now() < end) {
      turn(end);
    }
  }

  [[nodiscard]] Time now() const {
    return Time(
        static_cast<std::uint32_t>(std::chrono::duration_cast<microseconds>(wires->timeline.now()).count()));
  }
  Net& clock_net() { return wires->pins.at('B', 2); }
  Net& data_net() { return wires->pins.at('B', 3); }

 private:
  struct Wires {
    Timeline timeline;
    Pins pins;
  };

  void begin() {
    const Chip& chip = family == Family::Tm4c ? kTm4c123 : kLm3s6965;
    mcu.emplace(chip, wires->timeline, wires->pins, behaviour_);
    using hal::stellaris::SystemControl;
    SystemControl::open({0, 1U << 12U, 1U << 1U});
    SystemControl::use({chip.crystal_code, 4});
    driver.emplace();
    mcu->on_exception([this](unsigned /*exception*/) {
      driver->master().on_interrupt();
      woken_ = true;
    });
    mcu->write(Core::kBase + Core::kSetEnable, 1U << kI2cInterrupt);
    clocks = clocks_before_start = starts = stops = 0;
    driver->master().start();
  }

  /// Runs one turn of the main loop, and then lets time pass until the next turn. Stops at `end` at the
  /// latest, so that a test can continue in the middle of a byte.
  void turn(Instant end = kNever) {
    woken_ = false;
    const std::uint64_t before = mcu->accesses();
    const bool again = driver->poll(now());
    EXPECT_LE(mcu->accesses() - before, kMostAccessesATurn);
    const Instant next_tick =
        std::min(end, wires->timeline.now() + (again ? Instant(microseconds(2)) : Instant(milliseconds(1))));
    while (!woken_ && wires->timeline.now() < next_tick) {
      mcu->run_until(
          std::min(next_tick, std::max(wires->timeline.next(), wires->timeline.now() + Instant(1))));
    }
  }

  I2cBehaviour behaviour_;
  bool woken_ = false;

 public:
  std::vector<std::uint8_t> memory;
  std::optional<Wires> wires;
  std::optional<EepromChip> eeprom;
  std::optional<Microcontroller> mcu;
  std::optional<Driver> driver;
  // Counts since the last reset.
  unsigned clocks = 0;               ///< rising edges of the clock line
  unsigned clocks_before_start = 0;  ///< `clocks` at the first START
  unsigned starts = 0;
  unsigned stops = 0;
};

std::vector<std::uint8_t> some_bytes(std::size_t count, unsigned seed = 0) {
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < count; ++i) {
    bytes.push_back(static_cast<std::uint8_t>(i * 29 + seed * 7 + 3));
  }
  return bytes;
}

struct Lm3sPlain {
  static constexpr Family kFamily = Family::Lm3s;
  static constexpr I2cBehaviour kBehaviour{};
};
struct Tm4cPlain {
  static constexpr Family kFamily = Family::Tm4c;
  static constexpr I2cBehaviour kBehaviour{};
};
struct Tm4cTellsStops {
  static constexpr Family kFamily = Family::Tm4c;
  static constexpr I2cBehaviour kBehaviour{true, true, false};
};
struct Tm4cLosesWithoutError {
  static constexpr Family kFamily = Family::Tm4c;
  static constexpr I2cBehaviour kBehaviour{false, false, false, true};
};
struct Lm3sWaits {
  static constexpr Family kFamily = Family::Lm3s;
  static constexpr I2cBehaviour kBehaviour{true, false, true};
};

template <class Kind>
class Eeprom : public testing::Test {
 protected:
  using TheBench = Bench<Kind::kFamily>;
  static TheBench make() { return TheBench(Kind::kBehaviour); }

  /// Checks that the driver can write 40 bytes and read them back.
  static void expect_works(TheBench& bench, unsigned seed) {
    const auto bytes = some_bytes(40, seed);
    EXPECT_TRUE(bench.write(0x0150, bytes));
    std::vector<std::uint8_t> back(bytes.size());
    EXPECT_TRUE(bench.read(0x0150, back));
    EXPECT_EQ(back, bytes);
  }
};
using Kinds = testing::Types<Lm3sPlain, Tm4cPlain, Tm4cTellsStops, Tm4cLosesWithoutError, Lm3sWaits>;
TYPED_TEST_SUITE(Eeprom, Kinds);

TYPED_TEST(Eeprom, ReadsTheStoredBytesAtAnyAddress) {
  typename TestFixture::TheBench bench(TypeParam::kBehaviour);
  for (std::size_t i = 0; i < bench.memory.size(); ++i) {
    bench.memory[i] = static_cast<std::uint8_t>(i * 7 + i / 256);
  }
  for (const unsigned place : {0x0000U, 0x0001U, 0x001FU, 0x00FEU, 0x1234U, 0x1FE0U}) {
    const auto address = static_cast<std::uint16_t>(place);
    for (const std::size_t size : {1U, 2U, 28U, 32U}) {
      std::vector<std::uint8_t> bytes(size);
      ASSERT_TRUE(bench.read(address, bytes));
      EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), bench.memory.begin() + address)) << address;
    }
  }
}

TYPED_TEST(Eeprom, WritesPageByPageAtAnyAddress) {
  typename TestFixture::TheBench bench(TypeParam::kBehaviour);
  std::vector<std::uint8_t> expected = bench.memory;
  unsigned seed = 0;
  for (const unsigned place : {0x0000U, 0x0004U, 0x0005U, 0x001FU, 0x00F0U, 0x1FC5U}) {
    const auto address = static_cast<std::uint16_t>(place);
    for (const std::size_t size : {1U, 2U, 27U, 28U, 29U, 32U, 33U, 40U}) {
      const auto bytes = some_bytes(size, ++seed);
      ASSERT_TRUE(bench.write(address, bytes));
      std::copy(bytes.begin(), bytes.end(), expected.begin() + address);
      ASSERT_EQ(bench.memory, expected) << address << ", " << size;
    }
  }
  for (const EepromChip::Programmed& page : bench.eeprom->programmed()) {
    EXPECT_LE(page.address % EepromChip::kPage + page.size, EepromChip::kPage) << "wraps within its page";
  }
}

// After the STOP, the EEPROM takes at most 10 ms to program a page (tWR, doc. 0336, "AC characteristics").
TYPED_TEST(Eeprom, AWriteEndsAfterTheLastPageIsProgrammedWithAnyTimeOfTheDataSheet) {
  for (const int ms : {0, 1, 5, 10}) {
    typename TestFixture::TheBench bench(TypeParam::kBehaviour);
    bench.eeprom->set_programming_time(ms == 0 ? Instant(microseconds(1)) : Instant(milliseconds(ms)));
    const auto bytes = some_bytes(EepromChip::kPage);
    EXPECT_TRUE(bench.write(0x0010, bytes));
    EXPECT_FALSE(bench.eeprom->programming());
    EXPECT_EQ(bench.eeprom->programmed().size(), 2U);
    EXPECT_TRUE(ms < 5 || bench.eeprom->polls_refused() > 0);
    EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), bench.memory.begin() + 0x0010));
  }
}

TYPED_TEST(Eeprom, AWriteThatTakesLongerThanTheDataSheetAllowsFails) {
  typename TestFixture::TheBench bench(TypeParam::kBehaviour);
  bench.eeprom->set_programming_time(milliseconds(20));
  EXPECT_FALSE(bench.write(0x0000, some_bytes(4)));
  bench.run_for(milliseconds(20));
  bench.eeprom->set_programming_time(milliseconds(5));
  TestFixture::expect_works(bench, 1);
}

TYPED_TEST(Eeprom, AReadAfterAResetWaitsUntilTheEepromHasProgrammedThePage) {
  typename TestFixture::TheBench bench(TypeParam::kBehaviour);
  bench.eeprom->set_programming_time(milliseconds(10));
  const auto bytes = some_bytes(32);
  bench.driver->start_write(0x0040, {bytes.data(), bytes.size()}, bench.now());
  while (!bench.eeprom->programming()) {
    bench.run_for(microseconds(50));
  }
  bench.reset();
  std::vector<std::uint8_t> back(bytes.size());
  EXPECT_TRUE(bench.read(0x0040, back));
  EXPECT_EQ(back, bytes);
}

TYPED_TEST(Eeprom, EachJobFailsWithoutAHangIfTheEepromIsMissing) {
  for (const bool pull_ups_too : {false, true}) {
    typename TestFixture::TheBench bench(TypeParam::kBehaviour);
    bench.eeprom->remove(pull_ups_too);
    const Instant begun = bench.wires->timeline.now();
    std::vector<std::uint8_t> bytes(28);
    EXPECT_FALSE(bench.read(0, bytes));
    EXPECT_LE(bench.wires->timeline.now() - begun, milliseconds(15));
    EXPECT_FALSE(bench.write(0, bytes));
    EXPECT_FALSE(bench.read(0, bytes));
  }
}

TYPED_TEST(Eeprom, AWriteFailsAndProgramsNothingIfAByteAfterTheDeviceAddressIsNotAcknowledged) {
  for (unsigned taken = 1; taken < 20; ++taken) {
    typename TestFixture::TheBench bench(TypeParam::kBehaviour);
    bench.eeprom->refuse_after(taken);
    EXPECT_FALSE(bench.write(0x0100, some_bytes(17))) << taken;
    EXPECT_TRUE(std::all_of(bench.memory.begin(), bench.memory.end(),
                            [](std::uint8_t byte) { return byte == 0xFF; }));
    bench.eeprom->refuse_after(1000);
    TestFixture::expect_works(bench, taken);
  }
}

// --- a bus that is stuck ---

TYPED_TEST(Eeprom, AFreeBusGetsAtMostOneClockBeforeTheFirstStart) {
  typename TestFixture::TheBench bench(TypeParam::kBehaviour);
  std::vector<std::uint8_t> bytes(1);
  EXPECT_TRUE(bench.read(0, bytes));
  EXPECT_LE(bench.clocks_before_start, 1U);
}

TYPED_TEST(Eeprom, ADataLineHeldLowForUpToNineClocksIsFreed) {
  for (unsigned held = 1; held <= 9; ++held) {
    unsigned falls = 0;  // `falls` and `released` must outlive the wires
    bool released = false;
    typename TestFixture::TheBench bench(TypeParam::kBehaviour);
    bench.mcu.reset();
    bench.data_net().drive(End::Fault, Drive::Low);
    bench.clock_net().on_change([&bench, held, &falls, &released] {
      if (!released && !bench.clock_net().level() && ++falls == held) {
        released = true;
        bench.data_net().drive(End::Fault, Drive::Nothing);
      }
    });
    bench.reset();
    TestFixture::expect_works(bench, held);
    EXPECT_TRUE(released);
    EXPECT_LE(bench.clocks_before_start, 9U) << held;
    EXPECT_GE(bench.clocks_before_start, held);
    EXPECT_LE(bench.clocks_before_start, held + 1) << "at most one clock more than necessary";
  }
}

TYPED_TEST(Eeprom, AReadSucceedsAfterAResetAtAnyTimeDuringARead) {
  unsigned holding = 0;
  for (int step = 0; step < 90; ++step) {
    typename TestFixture::TheBench bench(TypeParam::kBehaviour);
    // Zeroes keep the data line low most of the time.
    std::fill(bench.memory.begin(), bench.memory.end(), 0x00);
    std::vector<std::uint8_t> bytes(16);
    bench.run_for(milliseconds(1));
    bench.driver->start_read(0, {bytes.data(), bytes.size()}, bench.now());
    bench.run_for(microseconds(23 * step));
    holding += bench.eeprom->pulls_data() ? 1U : 0U;
    bench.reset();
    EXPECT_TRUE(bench.read(0, bytes)) << step;
    EXPECT_EQ(bytes, std::vector<std::uint8_t>(16, 0));
    EXPECT_LE(bench.clocks_before_start, 9U);
    EXPECT_FALSE(bench.data_net().was_shorted() || bench.clock_net().was_shorted());
  }
  EXPECT_GT(holding, 15U) << "the EEPROM held the data line low at too few of the resets";
}

// A reset releases both pins. If the clock line rises before the data line, the rise of the data line is a
// STOP. If this happens directly after a byte, the STOP ends the write, and the EEPROM programs the bytes
// that it has received. No driver can prevent that; the driver frees the bus afterwards.
TYPED_TEST(Eeprom, FreeingTheBusAfterAResetDuringAWriteProgramsNothing) {
  constexpr std::uint16_t kPlace = 0x20;
  unsigned nothing = 0;
  unsigned cut_by_the_reset = 0;
  unsigned whole = 0;
  for (int step = 0; step < 300; ++step) {
    typename TestFixture::TheBench bench(TypeParam::kBehaviour);
    const auto bytes = some_bytes(20);
    bench.run_for(milliseconds(1));
    bench.driver->start_write(kPlace, {bytes.data(), bytes.size()}, bench.now());
    bench.run_for(nanoseconds(9700) * step);
    const bool stopped = bench.eeprom->programming();
    bench.mcu.reset();  // releases the pins
    std::vector<std::uint8_t> expected = bench.memory;
    const auto cells = bench.eeprom->being_programmed();
    for (const EepromChip::Cell& cell : cells) {
      expected.at(cell.place) = cell.value;
    }
    bench.reset();
    std::vector<std::uint8_t> back(bytes.size());
    ASSERT_TRUE(bench.read(kPlace, back)) << step;
    ASSERT_EQ(bench.memory, expected) << step;
    ASSERT_TRUE(std::equal(back.begin(), back.end(), expected.begin() + kPlace)) << step;
    EXPECT_TRUE(!stopped || back == bytes) << step << ": the driver must send STOP only after the last byte";
    EXPECT_TRUE(
        std::equal(cells.begin(), cells.end(), bytes.begin(),
                   [](const EepromChip::Cell& cell, std::uint8_t byte) { return cell.value == byte; }))
        << step;
    nothing += cells.empty() ? 1U : 0U;
    cut_by_the_reset += !stopped && !cells.empty() ? 1U : 0U;
    whole += stopped ? 1U : 0U;
  }
  EXPECT_GT(nothing, 50U) << "after too few of the resets, the EEPROM programmed nothing";
  EXPECT_GT(cut_by_the_reset, 0U);
  EXPECT_GT(whole, 50U);
}

enum class Line : std::uint8_t { Clock, Data };

TYPED_TEST(Eeprom, EachJobFailsInBoundedTimeWhileALineIsStuck) {
  for (const Line line : {Line::Clock, Line::Data}) {
    typename TestFixture::TheBench bench(TypeParam::kBehaviour);
    bench.mcu.reset();
    Net& net = line == Line::Clock ? bench.clock_net() : bench.data_net();
    net.drive(End::Fault, Drive::Low);
    bench.reset();
    for (int i = 0; i < 3; ++i) {
      const Instant begun = bench.wires->timeline.now();
      std::vector<std::uint8_t> bytes(28);
      EXPECT_FALSE(bench.read(0, bytes));
      EXPECT_FALSE(bench.write(0, bytes));
      EXPECT_LE(bench.wires->timeline.now() - begun, milliseconds(30));
    }
    net.drive(End::Fault, Drive::Nothing);
    bench.run_for(milliseconds(1));
    // The first job after the release may fail; the next one must not.
    std::vector<std::uint8_t> bytes(1);
    bench.read(0, bytes);
    TestFixture::expect_works(bench, 5);
  }
}

TYPED_TEST(Eeprom, ALineStuckForAShortTimeCausesNoFalseSuccessAndNoLastingFailure) {
  for (const Line line : {Line::Clock, Line::Data}) {
    for (const Instant held :
         {Instant(microseconds(40)), Instant(milliseconds(2)), Instant(milliseconds(6))}) {
      for (int step = 0; step < 33; ++step) {
        SCOPED_TRACE(std::string(line == Line::Clock ? "clock" : "data") + " for " +
                     std::to_string(held.count()) + " ps, step " + std::to_string(step));
        typename TestFixture::TheBench bench(TypeParam::kBehaviour);
        Net& net = line == Line::Clock ? bench.clock_net() : bench.data_net();
        Timeline& timeline = bench.wires->timeline;
        Alarm sticks(timeline, [&net] { net.drive(End::Fault, Drive::Low); });
        Alarm releases(timeline, [&net] { net.drive(End::Fault, Drive::Nothing); });
        bench.run_for(milliseconds(1));
        sticks.set_after(microseconds(67) * step);
        releases.set_after(microseconds(67) * step + held);
        const auto bytes = some_bytes(20, static_cast<unsigned>(step));
        if (bench.write(0x0200, bytes)) {
          EXPECT_TRUE(std::equal(bytes.begin(), bytes.end(), bench.memory.begin() + 0x0200))
              << "reported as written, but not stored";
        }
        bench.run_for(milliseconds(10));
        std::vector<std::uint8_t> back(20);
        // A job that finds the bus blocked frees it and may fail; the next job must succeed.
        const bool first = bench.read(0x0200, back);
        if (first) {
          EXPECT_TRUE(std::equal(back.begin(), back.end(), bench.memory.begin() + 0x0200))
              << "reported as read, but wrong";
        }
        TestFixture::expect_works(bench, 9);
        EXPECT_FALSE(net.was_shorted());
      }
    }
  }
}

}  // namespace
}  // namespace ex9000::registers
