// Tests how often a module in use writes its EEPROM, and compares the result with the number of write cycles
// that the manufacturer of the EEPROM guarantees.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <functional>
#include <utility>

#include "tests/firmware/module_bench.hpp"

namespace ex9000::sim {
namespace {

using PageWrites = std::array<unsigned, hal::doubles::Memory::kSize / hal::doubles::Memory::kPage>;
using Bytes = ModuleBench::Bytes;

/// The guaranteed number of write cycles of a page of an AT24C64: Atmel doc. 0336.
constexpr double kCycles = 1'000'000;
constexpr double kMinutesAYear = 525'600;
constexpr double kDaysAYear = 365;

/// Calls `use` a hundred times and returns the average number of writes per call. At least one call must
/// cause a write. Sets `pages` to the number of pages that have been written. Checks that the number of
/// writes of each page exceeds the average of these pages by at most one.
double writes_of(ModuleBench& bench, const std::function<void(unsigned round)>& use, unsigned& pages) {
  constexpr unsigned kRounds = 100;
  PageWrites writes{};
  bench.module().memory().keep([&writes](std::uint16_t address, ex9000::Bytes /*bytes*/) {
    ++writes.at(address / hal::doubles::Memory::kPage);
    return true;
  });
  for (unsigned round = 0; round < kRounds; ++round) {
    use(round);
  }
  unsigned all = 0;
  unsigned most = 0;
  pages = 0;
  for (const unsigned each : writes) {
    all += each;
    most = std::max(most, each);
    pages += each != 0 ? 1U : 0U;
  }
  EXPECT_LE(most, all / pages + 1) << "one page is written more often than the others";
  return static_cast<double>(all) / kRounds;
}

double years(double writes_a_year, unsigned pages) { return kCycles * pages / writes_a_year; }

TEST(Wear, IfTheHostWatchdogIsEnabledAndExpiresAndItsStatusIsClearedTheModuleWritesThreeTimes) {
  ModuleBench bench("EX9042D-M@01,protocol=ascii");
  unsigned pages = 0;
  const double writes = writes_of(
      bench,
      [&](unsigned /*round*/) {
        ASSERT_EQ(bench.ask("~013101"), "!01");  // enables the watchdog
        bench.run(std::chrono::milliseconds(300));
        ASSERT_EQ(bench.ask("~010"), "!0184");  // expired; one write stores the status and the disabled state
        ASSERT_EQ(bench.ask("~011"), "!01");    // clears the timeout status
      },
      pages);
  EXPECT_EQ(writes, 3);
  EXPECT_EQ(pages, 2U);
  const double a_year = writes * kMinutesAYear;
  std::printf("expiry of the host watchdog every minute: %.0f writes a year, guaranteed for %.1f years\n",
              a_year, years(a_year, pages));
  EXPECT_GT(years(a_year, pages), 1);
}

TEST(Wear, APowerOnValueCanBeStoredDailyFor1000Years) {
  ModuleBench bench("EX9042D-M");
  unsigned pages = 0;
  const double writes = writes_of(
      bench,
      [&](unsigned round) {
        const auto outputs = static_cast<std::uint8_t>(round + 1);
        ASSERT_EQ(bench.ask(Bytes{1, 0x0F, 0, 0xA0, 0, 8, 1, outputs}), (Bytes{1, 0x0F, 0, 0xA0, 0, 8}));
      },
      pages);
  EXPECT_EQ(writes, 1);
  const double a_year = writes * kDaysAYear;
  std::printf("power-on value stored daily: %.0f writes a year, guaranteed for %.0f years\n", a_year,
              years(a_year, pages));
  EXPECT_GT(years(a_year, pages), 1000);
}

TEST(Wear, PollingAndSwitchingWriteNothing) {
  ModuleBench bench("EX9042D-M");
  for (unsigned round = 0; round < 100; ++round) {
    const auto on = static_cast<std::uint8_t>(round % 2 == 0 ? 0xFF : 0x00);
    ASSERT_EQ(bench.ask(Bytes{1, 0x05, 0, 3, on, 0}), (Bytes{1, 0x05, 0, 3, on, 0}));
    ASSERT_EQ(bench.ask(Bytes{1, 0x01, 0, 0, 0, 8}).size(), 4U);
  }
  EXPECT_EQ(bench.module().memory().writes(), 0U);
}

TEST(Wear, CountersLatchesAndSamplesWriteNothing) {
  ModuleBench ascii("EX9052D,edge=rising");
  ModuleBench modbus("EX9052D-M");
  for (ModuleBench* bench : {&ascii, &modbus}) {
    for (unsigned channel = 0; channel < 8; ++channel) {
      bench->module().pulse_input(channel, 100'001);  // enough to wrap the counters
    }
    bench->run(std::chrono::seconds(2));
  }
  for (const char* command : {"#010", "$01C", "$01C0", "$01L1", "#**", "$014"}) {
    ascii.ask(command);
  }
  for (const Bytes& request : {Bytes{1, 0x04, 0, 0, 0, 8},
                               {1, 0x05, 0x01, 0x07, 0xFF, 0},
                               {1, 0x05, 0x02, 0, 0xFF, 0},
                               {1, 0x0F, 0x02, 0, 0, 8, 1, 0xFF}}) {
    ASSERT_EQ(modbus.ask(request).at(1), request[1]);
  }
  ASSERT_EQ(ascii.ask("#010"), "!0100000");  // `$01C0` has cleared this counter
  ASSERT_EQ(ascii.ask("#011"), "!0100001");
  EXPECT_EQ(ascii.module().memory().writes(), 0U);
  EXPECT_EQ(modbus.module().memory().writes(), 0U);
}

TEST(Wear, HostOksWriteNothing) {
  ModuleBench ascii("EX9042D");
  ASSERT_EQ(ascii.ask("~013105"), "!01");
  ModuleBench modbus("EX9042D-M");
  modbus.ask(Bytes{1, 0x06, 0x01, 0xE8, 0x00, 0x05});
  modbus.ask(Bytes{1, 0x05, 0x01, 0x04, 0xFF, 0x00});
  const auto before = std::pair(ascii.module().memory().writes(), modbus.module().memory().writes());
  for (unsigned i = 0; i < 100; ++i) {
    EXPECT_EQ(ascii.ask("~**"), "");
    EXPECT_EQ(modbus.ask(Bytes{static_cast<std::uint8_t>(i % 2), 0x03, 0x30, 0x38, 0x00, 0x00}), Bytes());
  }
  EXPECT_TRUE(ascii.module().module().state().settings.watchdog_enabled);
  EXPECT_TRUE(modbus.module().module().state().settings.watchdog_enabled);
  EXPECT_EQ(std::pair(ascii.module().memory().writes(), modbus.module().memory().writes()), before);
}

}  // namespace
}  // namespace ex9000::sim
