// Counts the erases of each sector over many stores of one or four pages, and compares the result with the
// manufacturer's guarantee. Also checks that reads erase and program nothing, and that resets erase and
// program nothing if nothing is stored.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/hal/flash/flash_bench.hpp"

namespace ex9000::hal::flash {
namespace {

/// The guaranteed number of erase cycles of a sector: W25Q16JV data sheet, "Features".
constexpr double kCycles = 100'000;
/// The required number of stores until a sector wears out, if there is no reset.
constexpr double kRequired = 10e6;

class PageStoreWear : public testing::Test {
 protected:
  PageStoreWear() { run_.settle(); }

  void write(std::size_t page) {
    ASSERT_TRUE(run_.write(page, numbered(content_++)));
    run_.settle();
  }
  /// Writes `page` so that its entry is the only entry in force (hal/flash/page_store.hpp) in a sector. The
  /// entry stays there until the page is written again.
  void pin(std::size_t page) {
    write(page);
    for (unsigned i = 0; i < kSlotsOfASector; ++i) {
      write(0);
    }
  }

  /// Carries out `store` many times. Calculates how many stores are possible before a sector wears out, from
  /// the erases of the sector that was erased most often. Checks and returns this number. Also checks that
  /// the sectors that are erased wear out evenly.
  template <class Store>
  double stores_until_worn(const char* what, Store store) {
    constexpr unsigned kStores = 20'000;
    const auto before = chip_.erases;
    for (unsigned i = 0; i < kStores; ++i) {
      store(i);
    }
    unsigned most = 0;
    unsigned all = 0;
    unsigned sectors = 0;
    for (unsigned sector = 0; sector < kSectors; ++sector) {
      const unsigned erases = chip_.erases[sector] - before[sector];
      most = std::max(most, erases);
      all += erases;
      sectors += erases != 0 ? 1U : 0U;
    }
    const double stores = kStores * kCycles / most;
    std::printf(
        "%s: %u stores, %u erases of %u sectors, at most %u erases of one sector; "
        "%.1f million stores until a sector has 100,000 erase cycles\n",
        what, kStores, all, sectors, most, stores / 1e6);
    EXPECT_LE(most, all / sectors + 2) << "one sector is erased more often than the others";
    EXPECT_GE(stores, kRequired);
    return stores;
  }

  FlashChip chip_;
  Session run_{chip_};
  unsigned content_ = 0;
};

TEST_F(PageStoreWear, AllowsTenMillionStoresOfSettingsInOnePage) {
  stores_until_worn("settings of one page, two copies in turn",
                    [this](unsigned i) { write(i % 2 == 0 ? 0 : 4); });
}

TEST_F(PageStoreWear, AllowsTenMillionStoresOfSettingsInFourPages) {
  stores_until_worn("settings of four pages, two copies in turn", [this](unsigned i) {
    for (std::size_t page = 0; page < 4; ++page) {
      write((i % 2 == 0 ? 0 : 4) + page);
    }
  });
}

TEST_F(PageStoreWear, AllowsTenMillionStoresOfAPageWhileEachOfTheOtherPagesIsAloneInASector) {
  for (std::size_t page = 1; page < kPages; ++page) {
    pin(page);
  }
  stores_until_worn("one page, while each of the other pages is alone in a sector",
                    [this](unsigned) { write(0); });
}

TEST_F(PageStoreWear, AReadErasesAndProgramsNothing) {
  write(1);
  const auto erases = chip_.erases;
  const unsigned programs = chip_.programs;
  for (unsigned i = 0; i < 1'000; ++i) {
    run_.page(i % kPages);
  }
  run_.settle();
  EXPECT_EQ(chip_.erases, erases);
  EXPECT_EQ(chip_.programs, programs);
}

TEST_F(PageStoreWear, ResetsEraseAndProgramNothingIfNothingIsStored) {
  write(1);
  Session(chip_).settle();
  const auto erases = chip_.erases;
  const unsigned programs = chip_.programs;
  for (unsigned i = 0; i < 100; ++i) {
    Session next(chip_);
    next.page(1);
    next.settle();
  }
  EXPECT_EQ(chip_.erases, erases);
  EXPECT_EQ(chip_.programs, programs);
}

// After a reset, the first store begins a new sector.
TEST_F(PageStoreWear, AllowsAMillionStoresIfEachFollowsAReset) {
  constexpr unsigned kResets = 2'000;
  write(0);
  write(4);
  const auto before = chip_.erases;
  for (unsigned i = 0; i < kResets; ++i) {
    Session next(chip_);
    ASSERT_TRUE(next.write(i % 2 == 0 ? 0 : 4, numbered(i)));
    next.settle();
  }
  unsigned most = 0;
  for (unsigned sector = 0; sector < kSectors; ++sector) {
    most = std::max(most, chip_.erases[sector] - before[sector]);
  }
  const double stores = kResets * kCycles / most;
  std::printf(
      "a store after each reset: %u stores, at most %u erases of one sector; "
      "%.1f million stores until a sector has 100,000 erase cycles\n",
      kResets, most, stores / 1e6);
  EXPECT_GE(stores, 1e6);
}

}  // namespace
}  // namespace ex9000::hal::flash
