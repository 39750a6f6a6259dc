// How often an EEPROM is written in use, against what its maker promises.
#include <gtest/gtest.h>

#include <array>
#include <cstdio>
#include <functional>

#include "tests/unit/module_bench.hpp"

namespace ex9000::sim {
namespace {

using PageWrites = std::array<unsigned, hal::doubles::Memory::kSize / hal::doubles::Memory::kPage>;
using Bytes = ModuleBench::Bytes;

/// AT24C64, Atmel doc. 0336: write cycles of a page.
constexpr double kCycles = 1'000'000;
constexpr double kMinutesAYear = 525'600;
constexpr double kDaysAYear = 365;

/// What one repetition of `use` writes, on average of a hundred; it shall be the same for all pages in use.
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
  EXPECT_LE(most, all / pages + 1) << "one page wears out before the others";
  return static_cast<double>(all) / kRounds;
}

double years(double writes_a_year, unsigned pages) { return kCycles * pages / writes_a_year; }

TEST(Wear, OfAHostWatchdogThatExpiresEveryMinuteTakesThreeWritesEachAndAYearForAMillionOnEachPage) {
  ModuleBench bench("EX9042D-M@01,protocol=ascii");
  unsigned pages = 0;
  const double writes = writes_of(
      bench,
      [&](unsigned /*round*/) {
        ASSERT_EQ(bench.ask("~013101"), "!01");  // enabled
        bench.run(std::chrono::milliseconds(300));
        ASSERT_EQ(bench.ask("~010"), "!0184");  // expired, status and disabling in one
        ASSERT_EQ(bench.ask("~011"), "!01");    // cleared
      },
      pages);
  EXPECT_EQ(writes, 3);
  EXPECT_EQ(pages, 2U);
  const double a_year = writes * kMinutesAYear;
  std::printf("host watchdog expiring every minute: %.0f writes a year, %.1f years\n", a_year,
              years(a_year, pages));
  EXPECT_GT(years(a_year, pages), 1);
}

TEST(Wear, OfOutputsStoredDailyOutlivesTheDevice) {
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
  std::printf("power-on value stored daily: %.0f writes a year, %.0f years\n", a_year, years(a_year, pages));
  EXPECT_GT(years(a_year, pages), 1000);
}

TEST(Wear, OfPollingAndSwitchingIsNone) {
  ModuleBench bench("EX9042D-M");
  for (unsigned round = 0; round < 100; ++round) {
    const auto on = static_cast<std::uint8_t>(round % 2 == 0 ? 0xFF : 0x00);
    ASSERT_EQ(bench.ask(Bytes{1, 0x05, 0, 3, on, 0}), (Bytes{1, 0x05, 0, 3, on, 0}));
    ASSERT_EQ(bench.ask(Bytes{1, 0x01, 0, 0, 0, 8}).size(), 4U);
  }
  EXPECT_EQ(bench.module().memory().writes(), 0U);
}

}  // namespace
}  // namespace ex9000::sim
