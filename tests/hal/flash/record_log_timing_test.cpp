// Measures and checks how long loads and saves take, and at which rate settings can be saved.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>

#include "tests/hal/flash/flash_bench.hpp"

namespace ex9000::hal::flash {
namespace {

constexpr std::uint64_t kLongestSaveEver = 8'000;  // us; hal/flash/record_log.hpp
constexpr std::uint64_t kShortestPeriod = 18'000;  // us; hal/flash/record_log.hpp

/// Saves at most `most` times. Each save begins at least `period` microseconds after the previous one began.
/// Returns the number of saves before the first save that fails; `most` if there is none.
unsigned saves_without_failure(OnFlash& run, FlashChip& chip, std::uint64_t period, unsigned most) {
  for (unsigned saves = 0; saves < most; ++saves) {
    const std::uint64_t next = chip.now + period;
    if (!run.save(numbered(saves))) {
      return saves;
    }
    if (chip.now < next) {
      run.run(next - chip.now);
    }
  }
  return most;
}

TEST(RecordLogTiming, SavesEndInTimeInAnyPhaseOfAnErase) {
  for (const FlashChip::Times& times : {FlashChip::Times(), FlashChip::kLongest}) {
    FlashChip chip = settled(times);
    OnFlash before(chip);
    // The last of these saves opens the second sector. The first sector is free then, so its erase begins.
    for (unsigned i = 0; i < kPlacesOfASector; ++i) {
      ASSERT_TRUE(before.save(numbered(i)));
    }
    std::uint64_t longest = 0;
    unsigned suspensions = 0;
    for (std::uint64_t phase = 0; phase < times.erase + 10'000; phase += phase < 8'000 ? 333 : 5'333) {
      FlashChip copy = chip;
      OnFlash run(copy, before);
      run.run(phase);
      ASSERT_TRUE(run.save(numbered(100)));
      longest = std::max(longest, run.latency);
      suspensions += copy.suspensions;
    }
    EXPECT_GT(suspensions, 10U);
    EXPECT_LE(longest, kLongestSaveEver);
    std::printf("erase %u ms, program %.1f ms: longest save %.1f ms\n",
                static_cast<unsigned>(times.erase / 1'000), static_cast<double>(times.program) / 1e3,
                static_cast<double>(longest) / 1e3);
  }
}

TEST(RecordLogTiming, SavesWithPausesNeverWaitForAnEraseWithTheLongestTimes) {
  std::uint64_t longest = 0;
  FlashChip chip = settled(FlashChip::kLongest);
  OnFlash run(chip);
  for (unsigned i = 0; i < 20'000; ++i) {
    const std::uint64_t next = chip.now + kShortestPeriod + i % 7 * 331;
    ASSERT_TRUE(run.save(numbered(i)));
    longest = std::max(longest, run.latency);
    run.run(next - chip.now);
  }
  EXPECT_LE(longest, kLongestSaveEver);
  std::printf("longest of 20000 saves: %.1f ms\n", static_cast<double>(longest) / 1e3);
}

TEST(RecordLogTiming, SavesEvery4MsNeverFailWithTypicalTimes) {
  constexpr unsigned kSaves = 20'000;
  FlashChip chip = settled({});
  OnFlash run(chip);
  EXPECT_EQ(saves_without_failure(run, chip, 4'000, kSaves), kSaves);
}

TEST(RecordLogTiming, TheSectorsErasedInAdvanceHaveRoomForABurst) {
  constexpr unsigned kBurst = kSectors * (kPlacesOfASector - 1);
  FlashChip chip = settled({45'000, 3'000});
  chip.times.erase = 1'000'000'000;  // an erase takes longer than all saves of this test
  OnFlash run(chip);
  EXPECT_EQ(saves_without_failure(run, chip, 0, 10 * kBurst), kBurst);
  EXPECT_LE(run.latency, Log::kLongestSave.microseconds() + 2'000) << "a failing save must end in time";
}

TEST(RecordLogTiming, TheScanOfAFullLogOfTheLongestRecordsTakesAtMost35MsAt16MHz) {
  FlashChip chip;
  RecordBytes record{};
  for (unsigned place = 0; place < kPlaces; ++place) {
    record.fill(0);
    record[0] = kLayout;
    record[1] = kRecordRoom - 8;
    write_record(the_model(), numbered(place), static_cast<std::uint16_t>(place), record);
    const auto at = static_cast<std::ptrdiff_t>(place * kRecordRoom);
    std::copy_n(record.begin(), place % kPlacesOfASector == 0 ? 0 : kRecordRoom, chip.cells.begin() + at);
  }
  EXPECT_TRUE(OnFlash(chip).stored() == numbered(kPlaces - 1));
  constexpr double kBytesAMicrosecond = 2;  // SPI with one data line and a clock of 16 MHz
  const double most = static_cast<double>(chip.bytes_read) / kBytesAMicrosecond / 1e3;
  std::printf("scan of a full log: %llu bytes, %.1f ms\n", static_cast<unsigned long long>(chip.bytes_read),
              most);
  EXPECT_LE(most, 35);
}

}  // namespace
}  // namespace ex9000::hal::flash
