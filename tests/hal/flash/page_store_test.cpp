// Tests the page store: it returns what was written, obeys the rules of a flash, and tolerates resets of the
// MCU and defects of the flash. page_store_cuts_test.cpp tests power cuts during writes.
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <vector>

#include "tests/hal/flash/flash_bench.hpp"

namespace ex9000::hal::flash {
namespace {

const Page kBlank = [] {
  Page page{};
  page.fill(0xFF);
  return page;
}();

std::vector<std::uint8_t> bytes_of(const Page& page) { return {page.begin(), page.end()}; }

TEST(PageStore, ReadsFFWhereNothingWasWritten) {
  FlashChip chip;
  Session run(chip);
  std::vector<std::uint8_t> all(kStoreSize, 0x55);
  ASSERT_TRUE(run.read(0, all));
  EXPECT_EQ(all, std::vector<std::uint8_t>(kStoreSize, 0xFF));
}

TEST(PageStore, KeepsPagesThroughAReset) {
  FlashChip chip;
  {
    Session run(chip);
    run.settle();
    for (unsigned page = 0; page < kPages; ++page) {
      ASSERT_TRUE(run.write(page, numbered(page)));
      EXPECT_EQ(run.page(page), numbered(page));
    }
    ASSERT_TRUE(run.write(3, numbered(300)));
  }
  Session run(chip);
  for (unsigned page = 0; page < kPages; ++page) {
    EXPECT_EQ(run.page(page), numbered(page == 3 ? 300 : page));
  }
}

/// The flashes of modules in use hold bytes in this format, so later firmware must be able to read it.
TEST(PageStore, ReadsAndWritesTheSameBytesAsEarlierFirmware) {
  constexpr std::array<std::uint8_t, 8> kMarkOfAnErasedSector{0x45, 0x58, 0x39, 0xC6, 0xA7, 0x9B, 0x53, 0x1D};
  // Sequence 7, page 3, a content of the bytes 0 to 31, and the CRC-32 of all these bytes.
  std::vector<std::uint8_t> entry{7, 0, 0, 0, 3};
  Page content{};
  for (std::size_t i = 0; i < content.size(); ++i) {
    content[i] = static_cast<std::uint8_t>(i);
  }
  entry.insert(entry.end(), content.begin(), content.end());
  entry.insert(entry.end(), {0x89, 0x8C, 0xD8, 0xC3});

  FlashChip chip;
  std::fill_n(chip.cells.begin(), 8, std::uint8_t{0});
  std::copy(entry.begin(), entry.end(), chip.cells.begin() + 256 + 48);  // second slot of flash page 1
  for (std::size_t sector = 1; sector < 14; ++sector) {
    std::copy(kMarkOfAnErasedSector.begin(), kMarkOfAnErasedSector.end(),
              chip.cells.begin() + static_cast<std::ptrdiff_t>(sector * 4096));
  }
  Session run(chip);
  EXPECT_EQ(run.page(3), content);
  run.settle();
  for (const auto erases : chip.erases) {
    EXPECT_EQ(erases, 0U);
  }

  // The store must put the next entry into the first slot after the mark of the next sector.
  content[0] = 0xFF;
  entry = {8, 0, 0, 0, 3};
  entry.insert(entry.end(), content.begin(), content.end());
  entry.insert(entry.end(), {0x3E, 0x11, 0x88, 0xC8});
  entry.insert(entry.end(), 7, 0xFF);  // up to the next slot
  ASSERT_TRUE(run.write(3, content));
  EXPECT_EQ(std::vector<std::uint8_t>(chip.cells.begin() + 4096, chip.cells.begin() + 4104),
            std::vector<std::uint8_t>(8, 0));
  EXPECT_EQ(std::vector<std::uint8_t>(chip.cells.begin() + 4096 + 48, chip.cells.begin() + 4096 + 96), entry);
}

TEST(PageStore, ASealedEntryIsGoodAndTheByteAfterItIsUnchanged) {
  struct {
    EntryBytes entry{};
    std::uint8_t after = 0x55;
  } bytes;
  seal(bytes.entry, 0x0102'0304, kPages - 1);
  EXPECT_EQ(bytes.after, 0x55);
  EXPECT_TRUE(is_good(bytes.entry));
}

TEST(PageStore, AWriteOfAPartOfAPageKeepsTheRest) {
  FlashChip chip;
  Session run(chip);
  run.settle();
  Page expected = numbered(7);
  ASSERT_TRUE(run.write(5, expected));
  const std::uint8_t zeros[8]{};
  ASSERT_TRUE(run.write(5 * kPage + 20, Bytes{zeros, sizeof zeros}));
  std::fill_n(expected.begin() + 20, 8, std::uint8_t{0});
  EXPECT_EQ(run.page(5), expected);
  EXPECT_EQ(Session(chip).page(5), expected);
  ASSERT_TRUE(run.write(6 * kPage + 31, Bytes{zeros, 1}));
  Page last = kBlank;
  last[31] = 0;
  EXPECT_EQ(run.page(6), last);
}

TEST(PageStore, AReadAcrossPagesReturnsTheBytesOfEachPage) {
  FlashChip chip;
  Session run(chip);
  run.settle();
  ASSERT_TRUE(run.write(0, numbered(1)));
  ASSERT_TRUE(run.write(2, numbered(2)));
  std::vector<std::uint8_t> bytes(64);
  ASSERT_TRUE(run.read(16, bytes));
  std::vector<std::uint8_t> expected = bytes_of(numbered(1));
  expected.erase(expected.begin(), expected.begin() + 16);
  expected.insert(expected.end(), kPage, 0xFF);
  const Page third = numbered(2);
  expected.insert(expected.end(), third.begin(), third.begin() + 16);
  EXPECT_EQ(bytes, expected);
}

TEST(PageStore, AJobThatGoesBeyondTheEndFailsAndAWriteAcrossPagesFails) {
  FlashChip chip;
  Session run(chip);
  run.settle();
  const Page page = numbered(1);
  std::vector<std::uint8_t> bytes(2);
  EXPECT_FALSE(run.read(kStoreSize - 1, bytes));
  EXPECT_FALSE(run.read(0xFFFF, bytes));
  EXPECT_FALSE(run.write(kStoreSize, Bytes{page.data(), 1}));
  EXPECT_FALSE(run.write(1, Bytes{page.data(), kPage}));
  EXPECT_FALSE(run.write(0xFFFF, Bytes{page.data(), 2}));
  EXPECT_TRUE(run.read(kStoreSize - 2, bytes));
  EXPECT_TRUE(run.write(kStoreSize - 1, Bytes{page.data(), 1}));
}

TEST(PageStore, StartsOnAFlashWithRandomContent) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    FlashChip chip;
    std::mt19937 random(seed);
    std::generate(chip.cells.begin(), chip.cells.end(), [&] { return static_cast<std::uint8_t>(random()); });
    Session run(chip);
    for (unsigned page = 0; page < kPages; ++page) {
      ASSERT_EQ(run.page(page), kBlank);
    }
    run.settle();
    ASSERT_TRUE(run.write(1, numbered(1)));
    EXPECT_EQ(Session(chip).page(1), numbered(1));
  }
}

TEST(PageStore, AnEntryOfOnlyFFOrOnlyZerosIsNotGood) {
  EntryBytes entry;
  entry.fill(0xFF);
  EXPECT_FALSE(is_good(entry));
  entry.fill(0);
  EXPECT_FALSE(is_good(entry));
}

TEST(PageStore, RandomSequencesOfWritesPausesAndPowerCyclesKeepAllPages) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    FlashChip chip;
    std::mt19937 random(seed);
    std::vector<Page> expected(kPages, kBlank);
    for (unsigned boots = 0; boots < 15; ++boots) {
      Session run(chip);
      for (unsigned page = 0; page < kPages; ++page) {
        ASSERT_EQ(run.page(page), expected[page]) << "page " << page << ", seed " << seed;
      }
      run.settle();
      for (std::uint64_t writes = random() % 400; writes > 0; --writes) {
        const auto page = static_cast<unsigned>(random() % kPages);
        // Pages 4 to 11 are rarely written, so that their entries stay in the same slots for a long time.
        if (page >= 4 && random() % 100 != 0) {
          continue;
        }
        expected[page] = numbered(static_cast<unsigned>(random()));
        ASSERT_TRUE(run.write(page, expected[page])) << "seed " << seed;
        ASSERT_EQ(run.page(page), expected[page]);
        run.run(random() % 20'000);
      }
      run.run(random() % 100'000);
      chip.power_off({});  // between two jobs; an erase may be running
    }
  }
}

// --- resets of the MCU, which do not stop the flash ---

TEST(PageStore, AResetOfTheMcuAtAnyTimeLeavesTheOldOrTheNewPage) {
  FlashChip settled;
  Session(settled).settle();
  for (const FlashChip::Times times : {FlashChip::Times(), FlashChip::kLongest}) {
    for (unsigned delay = 0; delay < 200; ++delay) {
      FlashChip chip = settled;
      chip.times = times;
      Session before(chip);
      ASSERT_TRUE(before.write(1, numbered(1)));
      ASSERT_TRUE(before.write(2, numbered(2)));
      const Page page = numbered(3);
      before.store().start_write(kPage, {page.data(), page.size()}, chip.time());
      for (unsigned i = 0; i < delay; ++i) {
        before.store().poll(chip.time());
        chip.run(i < 100 ? 100 : 3'000);
      }
      Session after(chip);
      const Page found = after.page(1);
      EXPECT_TRUE(found == numbered(1) || found == numbered(3)) << delay;
      EXPECT_LE(after.latency, 60'000U) << "the first job after a reset must not wait for an erase";
      EXPECT_EQ(after.page(2), numbered(2));
      ASSERT_TRUE(after.write(2, numbered(4)));
      after.settle();
      EXPECT_EQ(Session(chip).page(2), numbered(4));
      EXPECT_EQ(Session(chip).page(1), found);
    }
  }
}

TEST(PageStore, AnEraseThatTheMcuSuspendedBeforeItsResetIsContinued) {
  FlashChip chip;
  Session(chip).settle();
  chip.start_program(FlashChip::kBegin, Bytes{kNoMark.data(), kNoMark.size()});
  chip.run(1'000);
  chip.start_erase(FlashChip::kBegin);
  chip.run(1'000);
  chip.suspend();
  chip.run(100);
  ASSERT_TRUE(chip.erase_suspended());
  Session run(chip);
  ASSERT_TRUE(run.write(1, numbered(1)));
  run.settle();
  EXPECT_FALSE(chip.erase_suspended());
  EXPECT_EQ(run.page(1), numbered(1));
}

// --- a flash that fails ---

TEST(PageStore, TheNextAttemptSucceedsIfAWriteIntoABrokenSectorFails) {
  for (std::size_t broken = 0; broken < 2 * FlashChip::kSector; broken += broken < 200 ? 7 : 203) {
    FlashChip chip;
    chip.broken = broken;
    Session run(chip);
    run.settle();
    unsigned failures = 0;
    for (unsigned i = 0; i < 300; ++i) {
      run.run(5'000);
      const bool first = run.write(i % 2, numbered(i));
      failures += first ? 0 : 1;
      ASSERT_TRUE(first || run.write(i % 2, numbered(i))) << broken;
      ASSERT_EQ(run.page(i % 2), numbered(i));
    }
    ASSERT_EQ(Session(chip).page(1), numbered(299));
    EXPECT_LE(failures, 2U) << broken;
  }
}

TEST(PageStore, TheNextAttemptSucceedsIfAWriteIntoAWornOutSectorFails) {
  FlashChip chip;
  chip.broken = kFlashPage;
  chip.broken_size = FlashChip::kSector - kFlashPage;
  Session run(chip);
  run.settle();
  unsigned failures = 0;
  for (unsigned i = 0; i < 3'000; ++i) {
    const bool first = run.write(i % 2, numbered(i));
    failures += first ? 0 : 1;
    ASSERT_TRUE(first || run.write(i % 2, numbered(i)));
    ASSERT_EQ(run.page(i % 2), numbered(i));
    run.run(2'000);
  }
  EXPECT_LE(failures, 4U) << "at most one failure in each round through the sectors";
}

TEST(PageStore, ASectorThatCannotBeMarkedIsNotErasedRepeatedly) {
  FlashChip chip;
  chip.broken = 3 * FlashChip::kSector;
  chip.broken_size = kMark.size();
  chip.broken_keeps = true;
  Session run(chip);
  run.settle();
  EXPECT_EQ(chip.erases[3], 1U);
  for (unsigned i = 0; i < 1'000; ++i) {
    ASSERT_TRUE(run.write(i % 2, numbered(i)));
  }
  EXPECT_EQ(Session(chip).page(1), numbered(999));
}

TEST(PageStore, ASectorWhoseMarkCannotBeClearedIsNotWritten) {
  FlashChip chip;
  Session(chip).settle();
  chip.broken = 0;
  chip.broken_size = kMark.size();
  chip.broken_keeps = true;
  Session run(chip);
  for (unsigned i = 0; i < 50; ++i) {
    ASSERT_TRUE(run.write(i % 2, numbered(i)));
    run.settle();
  }
  const auto sector = chip.cells.begin();
  EXPECT_EQ(std::count(sector + kMark.size(), sector + FlashChip::kSector, 0xFF),
            static_cast<std::ptrdiff_t>(FlashChip::kSector - kMark.size()));
  EXPECT_EQ(Session(chip).page(1), numbered(49));
}

TEST(PageStore, EachJobFailsInTimeWhileTheFlashHangsAndLaterJobsSucceed) {
  FlashChip chip;
  Session run(chip);
  run.settle();
  ASSERT_TRUE(run.write(1, numbered(1)));
  chip.hangs = true;
  std::vector<std::uint8_t> bytes(1);
  EXPECT_FALSE(run.read(0, bytes));
  EXPECT_LE(run.latency, Store::kLongestRead.microseconds() + 2'000);
  EXPECT_FALSE(run.write(1, numbered(2)));
  EXPECT_LE(run.latency, Store::kLongestWrite.microseconds() + 2'000);
  chip.hangs = false;
  EXPECT_EQ(run.page(1), numbered(1));
  EXPECT_TRUE(run.write(1, numbered(2)));
  EXPECT_EQ(run.page(1), numbered(2));
}

TEST(PageStore, AReadFailsInTimeIfTheFlashHangsFromTheStart) {
  FlashChip chip;
  chip.hangs = true;
  Session run(chip);
  std::vector<std::uint8_t> bytes(1);
  EXPECT_FALSE(run.read(0, bytes));
  EXPECT_LE(run.latency, Store::kLongestRead.microseconds() + 2'000);
}

TEST(PageStore, AGoodEntryIsUsedEvenIfItsProgrammingTookTooLong) {
  FlashChip chip;
  Session run(chip);
  run.settle();
  ASSERT_TRUE(run.write(1, numbered(1)));
  chip.times.program = 60'000;
  EXPECT_FALSE(run.write(1, numbered(2)));
  std::vector<std::uint8_t> bytes(1);
  EXPECT_FALSE(run.read(kPage, bytes)) << "the flash is still busy";
  run.run(100'000);
  chip.times.program = 400;
  EXPECT_EQ(run.page(1), numbered(2)) << "a reset would load this entry";
  EXPECT_EQ(Session(chip).page(1), numbered(2));
}

TEST(PageStore, IfOpeningASectorTakesTooLongTheWriteFailsAndALaterWriteSucceeds) {
  FlashChip chip;
  Session run(chip);
  run.run(70'000);  // by then, one sector is erased, and the erase of the next one is running
  chip.times.program = 60'000;
  EXPECT_FALSE(run.write(1, numbered(1)));
  run.run(100'000);
  chip.times.program = 400;
  run.settle();
  ASSERT_TRUE(run.write(1, numbered(2)));
  EXPECT_EQ(run.page(1), numbered(2));
  EXPECT_EQ(Session(chip).page(1), numbered(2));
}

TEST(PageStore, AResumedEraseIsNotSuspendedTooEarly) {
  FlashChip chip;
  Session run(chip);
  std::vector<std::uint8_t> bytes(1);
  ASSERT_TRUE(run.read(0, bytes));
  run.run(3'000);
  Store& store = run.store();
  store.start_read(0, {bytes.data(), bytes.size()}, chip.time());
  chip.run(FlashChip::kSuspend);
  ASSERT_TRUE(chip.erase_suspended());
  store.poll(chip.time());
  ASSERT_FALSE(store.busy());
  store.poll(chip.time());
  ASSERT_EQ(chip.operation(), FlashChip::Operation::Erase);
  chip.run(5);
  ASSERT_TRUE(run.read(0, bytes));  // FlashChip::suspend fails the test if it is called too early
  EXPECT_EQ(chip.suspensions, 2U);
}

TEST(PageStore, AReadOfADamagedEntryFailsAndTheNextWriteReplacesTheEntry) {
  FlashChip chip;
  Session run(chip);
  run.settle();
  ASSERT_TRUE(run.write(1, numbered(1)));
  const Page content = numbered(1);
  const auto at = std::search(chip.cells.begin(), chip.cells.end(), content.begin(), content.end());
  ASSERT_NE(at, chip.cells.end());
  *at ^= 1U;
  std::vector<std::uint8_t> bytes(kPage);
  EXPECT_FALSE(run.read(kPage, bytes));
  const std::uint8_t byte = 0x12;
  ASSERT_TRUE(run.write(kPage, Bytes{&byte, 1}));
  Page expected = kBlank;
  expected[0] = byte;
  EXPECT_EQ(run.page(1), expected);
}

}  // namespace
}  // namespace ex9000::hal::flash
