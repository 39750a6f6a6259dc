// Counts the erases of each sector over many saves, and compares the result with the manufacturer's
// guarantee. Also checks that resets erase and program nothing if nothing is saved.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/hal/flash/flash_bench.hpp"

namespace ex9000::hal::flash {
namespace {

/// The guaranteed number of erase cycles of a sector: W25Q16JV data sheet, "Features".
constexpr double kCycles = 100'000;

/// Calculates how many saves are possible before a sector wears out, from `saves` saves and the erases of the
/// sector that was erased most often. Also checks that the sectors wear out evenly.
double saves_until_worn(const char* what, unsigned saves, const FlashChip& chip,
                        const decltype(FlashChip::erases)& before) {
  unsigned most = 0;
  unsigned all = 0;
  for (unsigned sector = 0; sector < kSectors; ++sector) {
    const unsigned erases = chip.erases[sector] - before[sector];
    most = std::max(most, erases);
    all += erases;
  }
  const double until_worn = saves * kCycles / most;
  std::printf(
      "%s: %u saves, at most %u erases of one sector; %.1f million saves until a sector has 100,000\n", what,
      saves, most, until_worn / 1e6);
  EXPECT_LE(most, all / kSectors + 2) << "one sector is erased more often than the others";
  return until_worn;
}

TEST(RecordLogWear, AllowsFortyMillionSavesWithoutAReset) {
  constexpr unsigned kSaves = 20'000;
  FlashChip chip = settled();
  OnFlash run(chip);
  const auto before = chip.erases;
  for (unsigned i = 0; i < kSaves; ++i) {
    ASSERT_TRUE(run.save(numbered(i)));
    run.settle();
  }
  EXPECT_GE(saves_until_worn("without a reset", kSaves, chip, before), 40e6);
}

// After a reset, the first save begins a new sector.
TEST(RecordLogWear, AllowsAMillionSavesIfEachFollowsAReset) {
  constexpr unsigned kSaves = 2'000;
  FlashChip chip = settled();
  const auto before = chip.erases;
  for (unsigned i = 0; i < kSaves; ++i) {
    OnFlash run(chip);
    ASSERT_TRUE(run.save(numbered(i)));
    run.settle();
  }
  EXPECT_GE(saves_until_worn("a save after each reset", kSaves, chip, before), 1e6);
}

TEST(RecordLogWear, ResetsEraseAndProgramNothingIfNothingIsSaved) {
  FlashChip chip = settled();
  ASSERT_TRUE(OnFlash(chip).save(numbered(1)));
  OnFlash(chip).settle();
  const auto erases = chip.erases;
  const unsigned programs = chip.programs;
  for (unsigned i = 0; i < 100; ++i) {
    OnFlash(chip).settle();
  }
  EXPECT_EQ(chip.erases, erases);
  EXPECT_EQ(chip.programs, programs);
}

}  // namespace
}  // namespace ex9000::hal::flash
