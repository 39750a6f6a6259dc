// Measures and checks how long the jobs of the page store take, and at which rate pages can be written.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/hal/flash/flash_bench.hpp"

namespace ex9000::hal::flash {
namespace {

constexpr std::uint64_t kLongestReadEver = 5'000;    // us; hal/flash/page_store.hpp
constexpr std::uint64_t kLongestWriteEver = 14'000;  // us; hal/flash/page_store.hpp

/// Returns a chip with the given times. All its sectors are erased and marked.
FlashChip settled(const FlashChip::Times& times) {
  FlashChip chip;
  chip.times = times;
  Session(chip).settle();
  return chip;
}

/// Writes a page and reads it back, at most `most` times. Each write begins at least `period` microseconds
/// after the previous write began. If a write and its read take longer than `period`, the next write follows
/// immediately. Returns the number of writes before the first write that fails or whose page is wrong; `most`
/// if there is none.
unsigned writes_without_failure(Session& run, FlashChip& chip, std::uint64_t period, unsigned most) {
  for (unsigned writes = 0; writes < most; ++writes) {
    const std::uint64_t next = chip.now + period;
    if (!run.write(writes % 2, numbered(writes)) || run.page(writes % 2) != numbered(writes)) {
      return writes;
    }
    if (chip.now < next) {
      run.run(next - chip.now);
    }
  }
  return most;
}

TEST(PageStoreTiming, JobsEndInTimeInAnyPhaseOfAnErase) {
  for (const FlashChip::Times& times : {FlashChip::Times(), FlashChip::kLongest}) {
    std::uint64_t longest_read = 0;
    std::uint64_t longest_write = 0;
    unsigned suspensions = 0;
    const FlashChip chip = settled(times);
    for (std::uint64_t phase = 0; phase < times.erase + 10'000; phase += phase < 8'000 ? 333 : 5'333) {
      FlashChip before = chip;
      Session run(before);
      // The last of these writes opens the second sector. The first sector is free then, so its erase begins.
      for (unsigned i = 0; i < kSlotsOfASector; ++i) {
        ASSERT_TRUE(run.write(0, numbered(i)));
      }
      const std::uint64_t begin = before.now;
      while (before.now < begin + phase) {
        while (run.store().poll(before.time())) {
          before.run(10);
        }
        before.run(std::min<std::uint64_t>(333, begin + phase - before.now));
      }
      FlashChip for_read = before;
      Session reader(for_read, run.store());
      EXPECT_EQ(reader.page(0), numbered(kSlotsOfASector - 1));
      longest_read = std::max(longest_read, reader.latency);
      ASSERT_TRUE(run.write(1, numbered(phase & 0xFFFF)));
      longest_write = std::max(longest_write, run.latency);
      suspensions += before.suspensions;
    }
    EXPECT_GT(suspensions, 10U);
    EXPECT_LE(longest_read, kLongestReadEver);
    EXPECT_LE(longest_write, kLongestWriteEver);
    std::printf("erase %u ms, program %.1f ms: longest read %.1f ms, longest write %.1f ms\n",
                static_cast<unsigned>(times.erase / 1'000), static_cast<double>(times.program) / 1e3,
                static_cast<double>(longest_read) / 1e3, static_cast<double>(longest_write) / 1e3);
  }
}

TEST(PageStoreTiming, WritesWithPausesOfAtLeast12MsEndInTimeWithTheLongestTimes) {
  std::uint64_t longest = 0;
  FlashChip chip = settled(FlashChip::kLongest);
  Session run(chip);
  for (unsigned i = 0; i < 2'000; ++i) {
    ASSERT_TRUE(run.write(i % 2, numbered(i)));
    longest = std::max(longest, run.latency);
    run.run(12'000 + i % 7 * 331);
  }
  EXPECT_LE(longest, kLongestWriteEver);
  std::printf("longest of 2000 writes: %.1f ms\n", static_cast<double>(longest) / 1e3);
}

TEST(PageStoreTiming, WritesAtTheDocumentedRateNeverFailWithTheLongestTimes) {
  constexpr unsigned kWrites = 20'000;
  FlashChip chip = settled(FlashChip::kLongest);
  Session run(chip);
  EXPECT_EQ(writes_without_failure(run, chip, 12'000, kWrites), kWrites);
}

TEST(PageStoreTiming, WritesEvery4MsNeverFailWithTypicalTimes) {
  constexpr unsigned kWrites = 20'000;
  FlashChip chip = settled({});
  Session run(chip);
  EXPECT_EQ(writes_without_failure(run, chip, 4'000, kWrites), kWrites);
}

TEST(PageStoreTiming, TheSectorsErasedInAdvanceHaveRoomForABurst) {
  constexpr unsigned kBurst = (kSectors - 1) * (kSlotsOfASector - 1);
  FlashChip chip = settled({1'000'000'000, 3'000});  // an erase takes longer than all writes of this test
  chip.times = {1'000'000'000, 3'000};
  Session run(chip);
  const unsigned writes = writes_without_failure(run, chip, 0, 10 * kBurst);
  EXPECT_GE(writes, kBurst);
  EXPECT_LE(run.latency, Store::kLongestWrite.microseconds() + 2'000) << "a failing write must end in time";
}

TEST(PageStoreTiming, AWriteThatWaitsForAnEraseSucceedsIfTheEraseEndsInTime) {
  FlashChip chip;  // never used before, so no sector is known to be erased
  chip.times.erase = 15'000;
  Session run(chip);
  EXPECT_TRUE(run.write(0, numbered(1)));
  EXPECT_EQ(Session(chip).page(0), numbered(1));
}

TEST(PageStoreTiming, TheScanOfAFullLogTakesAtMost25MsAt16MHz) {
  FlashChip chip = settled({});
  chip.times = FlashChip::kLongest;
  Session(chip).settle();
  // The writes fill all sectors, because no erase ends before a write fails.
  FlashChip used = chip;
  used.times.erase = 1'000'000'000;
  Session run(used);
  writes_without_failure(run, used, 0, 10'000);
  used.power_off({});
  used.bytes_read = 0;
  Session next(used);
  (void)next.page(0);
  constexpr double kBytesAMicrosecond = 2;  // SPI with one data line and a clock of 16 MHz
  const double most = static_cast<double>(used.bytes_read) / kBytesAMicrosecond / 1e3;
  std::printf("scan of a full log: %llu bytes, %.1f ms\n", static_cast<unsigned long long>(used.bytes_read),
              most);
  EXPECT_LE(most, 25);
}

}  // namespace
}  // namespace ex9000::hal::flash
