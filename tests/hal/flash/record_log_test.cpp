// Tests the log of records: it loads what was saved, obeys the rules of a flash, and tolerates resets of the
// MCU and defects of the flash. tests/hal/record_cuts_test.cpp tests power cuts.
#include "hal/flash/record_log.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <vector>

#include "tests/hal/flash/flash_bench.hpp"
#include "tests/support/stored_settings.hpp"

namespace ex9000::hal::flash {
namespace {

constexpr std::uint16_t kSequence = 7;

/// Writes a record to a place of the chip.
void put(FlashChip& chip, unsigned place, const Settings& settings, std::uint16_t sequence,
         const Model& which = the_model()) {
  RecordBytes record{};
  write_record(which, settings, sequence, record);
  std::copy_n(record.begin(), record_size({record.data(), record.size()}),
              chip.cells.begin() + static_cast<std::ptrdiff_t>(place * kRecordRoom));
}

/// Returns the settings that a reset of a module with a copy of `chip` loads.
Settings loaded(FlashChip chip) { return OnFlash(chip).stored(); }

bool is_erased(const FlashChip& chip, std::size_t from, std::size_t size) {
  const auto begin = chip.cells.begin() + static_cast<std::ptrdiff_t>(from);
  return std::count(begin, begin + static_cast<std::ptrdiff_t>(size), 0xFF) ==
         static_cast<std::ptrdiff_t>(size);
}

TEST(RecordLog, ANewFlashMeansFactorySettings) {
  FlashChip chip;
  OnFlash run(chip);
  EXPECT_EQ(run.source(), SettingsSource::Blank);
  EXPECT_TRUE(run.stored() == factory());
  EXPECT_TRUE(run.keeper().certain());
}

TEST(RecordLog, FindsTheNewestRecordAcrossTheWrapOfTheSequence) {
  FlashChip chip;
  put(chip, 1, numbered(1), 0xFFFF);
  put(chip, 2, numbered(2), 0x0000);
  put(chip, 33, numbered(3), 0xFFFE);
  OnFlash run(chip);
  EXPECT_TRUE(run.stored() == numbered(2));
  EXPECT_TRUE(run.save(numbered(4)));
  EXPECT_TRUE(loaded(chip) == numbered(4));
}

/// The flashes of modules in use hold bytes in this format, so later firmware must be able to read it.
TEST(RecordLog, ReadsAndWritesTheSameBytesAsEarlierFirmware) {
  constexpr std::array<std::uint8_t, 8> kMarkOfAnErasedSector{0x45, 0x58, 0x39, 0xC6, 0xA7, 0x9B, 0x53, 0x1D};
  FlashChip chip;
  std::fill_n(chip.cells.begin(), 8, std::uint8_t{0});
  put(chip, 1, numbered(5), kSequence);  // at byte 128 of the first sector
  for (std::size_t sector = 1; sector < 14; ++sector) {
    std::copy(kMarkOfAnErasedSector.begin(), kMarkOfAnErasedSector.end(),
              chip.cells.begin() + static_cast<std::ptrdiff_t>(sector * 4096));
  }
  OnFlash run(chip);
  EXPECT_TRUE(run.stored() == numbered(5));
  run.settle();
  for (const auto erases : chip.erases) {
    EXPECT_EQ(erases, 0U);
  }

  // The log must put the next record into the first place after the mark of the next sector.
  ASSERT_TRUE(run.save(numbered(6)));
  FlashChip expected;
  put(expected, 33, numbered(6), kSequence + 1);
  std::fill_n(expected.cells.begin() + 4096, 8, std::uint8_t{0});
  EXPECT_TRUE(
      std::equal(chip.cells.begin() + 4096, chip.cells.begin() + 8192, expected.cells.begin() + 4096));
}

TEST(RecordLog, ARecordOfNewerFirmwareKeepsItsUnknownSettings) {
  FlashChip chip = settled();
  std::vector<std::uint8_t> memory(kStoredMemory, 0xFF);
  RecordBytes record{};
  write_record(the_model(), numbered(5), kSequence, record);
  std::copy(record.begin(), record.end(), memory.begin());
  lengthen(the_model(), memory.data(), 0, 96);
  std::fill_n(chip.cells.begin(), 8, std::uint8_t{0});
  std::copy_n(memory.begin(), 104, chip.cells.begin() + kRecordRoom);
  OnFlash run(chip);
  ASSERT_TRUE(run.stored() == numbered(5));
  ASSERT_TRUE(run.save(numbered(6)));
  EXPECT_TRUE(loaded(chip) == numbered(6));
  const auto unknown = memory.begin() + 4 + StoredCopy::bytes_of_all();
  EXPECT_TRUE(std::equal(unknown, memory.begin() + 100,
                         chip.cells.begin() + 33 * kRecordRoom + 4 + StoredCopy::bytes_of_all()));
}

// --- firmware/extensions.md: register 0x0306 ---

TEST(RecordLog, ReportsABadRecordAfterTheNewestGoodOne) {
  FlashChip chip;
  put(chip, 1, numbered(1), 1);
  EXPECT_EQ(OnFlash(chip).source(), SettingsSource::Good);
  put(chip, 2, numbered(2), 2);
  chip.cells[2 * kRecordRoom + 5] ^= 1U;
  EXPECT_EQ(OnFlash(chip).source(), SettingsSource::OneCopyBad);
  EXPECT_TRUE(loaded(chip) == numbered(1));
  ASSERT_TRUE(OnFlash(chip).save(numbered(3)));
  put(chip, 65, numbered(4), 2);
  chip.cells[65 * kRecordRoom + 5] ^= 1U;  // as after an interrupted erase of this sector
  EXPECT_EQ(OnFlash(chip).source(), SettingsSource::Good);
  chip.cells[33 * kRecordRoom + 5] ^= 1U;
  chip.cells[kRecordRoom + 5] ^= 1U;
  EXPECT_EQ(OnFlash(chip).source(), SettingsSource::NoneGood);
  EXPECT_TRUE(loaded(chip) == factory());
}

// The user may have programmed the image of another model by mistake.
TEST(RecordLog, SettingsOfAnotherModelAreUnreadableAndNotErasedUntilASave) {
  FlashChip chip = settled();
  const Model& other = model("EX9043D-M");
  put(chip, 1, Settings::factory(other), kSequence, other);
  std::fill_n(chip.cells.begin(), 8, std::uint8_t{0});
  OnFlash run(chip);
  EXPECT_EQ(run.source(), SettingsSource::NoneGood);
  run.idle(1'000'000);
  EXPECT_EQ(chip.erases[0], 1U);
  EXPECT_EQ(OnFlash(chip, other).source(), SettingsSource::Good);
  OnFlash again(chip);
  EXPECT_TRUE(again.save(numbered(1)));
  EXPECT_TRUE(loaded(chip) == numbered(1));
  again.settle();
  EXPECT_EQ(chip.erases[0], 2U);
}

TEST(RecordLog, StartsOnAFlashWithRandomContent) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    FlashChip chip;
    std::mt19937 random(seed);
    std::generate(chip.cells.begin(), chip.cells.end(), [&] { return static_cast<std::uint8_t>(random()); });
    OnFlash run(chip);
    EXPECT_TRUE(run.stored() == factory());
    run.idle(60'000);
    ASSERT_TRUE(run.save(numbered(1)));
    EXPECT_TRUE(loaded(chip) == numbered(1));
  }
}

TEST(RecordLog, RandomSequencesOfSavesPausesAndPowerCyclesKeepTheLastSettings) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    FlashChip chip;
    std::mt19937 random(seed);
    Settings expected = factory();
    for (unsigned boots = 0; boots < 15; ++boots) {
      OnFlash run(chip);
      ASSERT_TRUE(run.stored() == expected) << "seed " << seed;
      run.settle();
      for (std::uint64_t saves = random() % 100; saves > 0; --saves) {
        expected = numbered(static_cast<unsigned>(random() % 2'000'000));
        ASSERT_TRUE(run.save(expected)) << "seed " << seed;
        run.idle(random() % 20'000);
      }
      run.idle(random() % 100'000);
      chip.power_off({});  // between two jobs; an erase may be running
    }
  }
}

// --- resets of the MCU, which do not stop the flash ---

TEST(RecordLog, AResetOfTheMcuAtAnyTimeLeavesTheOldOrTheNewSettings) {
  for (const FlashChip::Times times : {FlashChip::Times(), FlashChip::kLongest}) {
    for (std::uint64_t delay = 0; delay < 60'000; delay += delay < 10'000 ? 100 : 3'000) {
      FlashChip chip = settled();
      chip.times = times;
      OnFlash before(chip);
      for (unsigned i = 1; i < kPlacesOfASector; ++i) {
        ASSERT_TRUE(before.save(numbered(i)));
      }
      before.begin_save(numbered(100));
      before.run(delay);
      OnFlash after(chip);
      EXPECT_TRUE(after.stored() == numbered(kPlacesOfASector - 1) || after.stored() == numbered(100))
          << delay;
      EXPECT_LE(after.latency, 20'000U) << "a load must not wait for an erase";
      ASSERT_TRUE(after.save(numbered(200)));
      after.settle();
      EXPECT_TRUE(loaded(chip) == numbered(200));
    }
  }
}

TEST(RecordLog, AnEraseThatTheMcuSuspendedBeforeItsResetIsContinued) {
  FlashChip chip = settled();
  chip.start_program(FlashChip::kBegin, Bytes{kNoMark.data(), kNoMark.size()});
  chip.run(1'000);
  chip.start_erase(FlashChip::kBegin);
  chip.run(1'000);
  chip.suspend();
  chip.run(100);
  ASSERT_TRUE(chip.erase_suspended());
  OnFlash run(chip);
  ASSERT_TRUE(run.save(numbered(1)));
  run.settle();
  EXPECT_FALSE(chip.erase_suspended());
  EXPECT_TRUE(loaded(chip) == numbered(1));
}

TEST(RecordLog, AResumedEraseIsNotSuspendedTooEarly) {
  FlashChip chip = settled();
  OnFlash run(chip);
  for (unsigned i = 0; i <= kPlacesOfASector; ++i) {
    ASSERT_TRUE(run.save(numbered(i)));  // the last one frees a sector, whose erase begins
  }
  run.begin_save(numbered(100));
  while (run.log().busy() || chip.operation() != FlashChip::Operation::Erase) {
    run.log().poll(chip.time());
    chip.run(1);
  }
  ASSERT_TRUE(run.end_save());
  chip.run(5);
  ASSERT_TRUE(run.save(numbered(101)));  // FlashChip::suspend fails the test if it is called too early
}

// --- a flash that fails ---

/// Saves settings and checks that at most `most` of the saves fail, and that a failed save changes nothing.
void expect_few_failures(FlashChip& chip, unsigned saves, unsigned most) {
  OnFlash run(chip);
  run.settle();
  unsigned failures = 0;
  for (unsigned i = 0; i < saves; ++i) {
    const Settings before = run.stored();
    const bool saved = run.save(numbered(i));
    failures += saved ? 0 : 1;
    ASSERT_TRUE(loaded(chip) == (saved ? numbered(i) : before)) << i;
    run.idle(5'000);
  }
  EXPECT_LE(failures, most);
}

TEST(RecordLog, ABrokenByteOrAWornOutSectorCausesNoFailure) {
  for (std::size_t broken = 0; broken < 2 * FlashChip::kSector; broken += broken < 300 ? 17 : 1'003) {
    FlashChip chip;
    chip.broken = broken;
    expect_few_failures(chip, 70, 0);
    ASSERT_FALSE(testing::Test::HasFailure()) << broken;
  }
  FlashChip worn;
  worn.broken = kFlashPage;
  worn.broken_size = FlashChip::kSector - kFlashPage;
  expect_few_failures(worn, 1'000, 0);
}

TEST(RecordLog, ASectorThatCannotBeMarkedIsNotErasedRepeatedly) {
  FlashChip chip;
  chip.broken = 3 * FlashChip::kSector;
  chip.broken_size = kMark.size();
  chip.broken_keeps = true;
  OnFlash(chip).settle();
  EXPECT_EQ(chip.erases[3], 1U);
  expect_few_failures(chip, 500, 0);
}

TEST(RecordLog, ASectorWhoseMarkCannotBeClearedIsNotWritten) {
  FlashChip chip = settled();
  chip.broken = 0;
  chip.broken_size = kMark.size();
  chip.broken_keeps = true;
  expect_few_failures(chip, 50, 0);
  EXPECT_TRUE(is_erased(chip, kMark.size(), FlashChip::kSector - kMark.size()));
}

// wire.md section 8: a refused command changes nothing. Here each attempt is complete in the flash.
TEST(RecordLog, IfTheReadBackDiffersThreeTimesAllRecordsOfTheSaveAreWithdrawn) {
  FlashChip chip = settled();
  OnFlash run(chip);
  ASSERT_TRUE(run.save(numbered(1)));
  chip.noisy_reads = 3;
  EXPECT_FALSE(run.save(numbered(2)));
  EXPECT_TRUE(run.keeper().certain());
  EXPECT_TRUE(loaded(chip) == numbered(1));
  chip.noisy_reads = 2;
  EXPECT_TRUE(run.save(numbered(3)));
  EXPECT_TRUE(loaded(chip) == numbered(3));
}

// wire.md D13: a module is ready to receive requests 100 ms after a reset. wire.md sections 3 and 7: it
// replies 200 ms after a command that stores.
TEST(RecordLog, AJobFailsInTimeWhileTheFlashHangsAndALaterOneSucceeds) {
  FlashChip chip = settled();
  OnFlash run(chip);
  ASSERT_TRUE(run.save(numbered(1)));
  chip.hangs = true;
  EXPECT_FALSE(run.save(numbered(2)));
  EXPECT_LE(run.latency, 90'000U) << "the save of a timeout may come first";
  OnFlash silent(chip);
  EXPECT_EQ(silent.source(), SettingsSource::NoneGood);
  EXPECT_LE(silent.latency, 50'000U);
  EXPECT_FALSE(silent.save(numbered(2)));
  EXPECT_LE(silent.latency, 90'000U);
  chip.hangs = false;
  EXPECT_TRUE(run.save(numbered(3)));
  EXPECT_TRUE(loaded(chip) == numbered(3));
}

// wire.md D15. The record becomes complete after its command has been refused.
TEST(RecordLog, ARecordWhoseProgrammingTookTooLongIsWithdrawn) {
  FlashChip chip = settled();
  OnFlash run(chip);
  ASSERT_TRUE(run.save(numbered(1)));
  chip.times.program = 90'000;
  EXPECT_FALSE(run.save(numbered(2)));
  EXPECT_FALSE(run.keeper().certain());
  chip.times.program = 400;
  run.idle(3'000'000);
  EXPECT_TRUE(run.keeper().certain());
  EXPECT_TRUE(loaded(chip) == numbered(1));
  EXPECT_TRUE(run.save(numbered(3)));
  EXPECT_TRUE(loaded(chip) == numbered(3));
}

TEST(RecordLog, ASaveAfterATimeoutWithdrawsTheRefusedRecordFirst) {
  FlashChip chip = settled();
  OnFlash run(chip);
  ASSERT_TRUE(run.save(numbered(1)));
  chip.times.program = 90'000;
  EXPECT_FALSE(run.save(numbered(2)));
  chip.times.program = 400;
  EXPECT_TRUE(run.save(numbered(3)));
  EXPECT_TRUE(run.keeper().certain());
  EXPECT_TRUE(loaded(chip) == numbered(3));
}

// Every sector holds settings of another model. An erase takes longer than a save may wait, so the first save
// fails; it must not cost the other model more than the sector that the save needs.
TEST(RecordLog, ARefusedSaveDoesNotEraseTheSettingsOfAnotherModel) {
  const Model& other = model("EX9043D-M");
  FlashChip chip;
  for (unsigned sector = 0; sector < kSectors; ++sector) {
    Settings settings = Settings::factory(other);
    settings.address = static_cast<std::uint8_t>(sector + 1);
    RecordBytes record{};
    write_record(other, settings, static_cast<std::uint16_t>(100 + sector), record);
    const auto begin = chip.cells.begin() + static_cast<std::ptrdiff_t>(sector * FlashChip::kSector);
    std::fill_n(begin, kMark.size(), std::uint8_t{0});
    std::copy_n(record.begin(), record_size({record.data(), record.size()}), begin + kRecordRoom);
  }
  chip.times = FlashChip::kLongest;
  OnFlash run(chip);
  EXPECT_FALSE(run.save(numbered(1)));
  run.run(10'000'000);
  chip.power_off({});
  EXPECT_EQ(OnFlash(chip, other).stored().address, kSectors);
}

// The first erases of a new flash are still running when the save fails. FlashChip fails the test if the log
// programs a place of an erased sector twice.
TEST(RecordLog, TheSectorOfARefusedRecordIsNotErasedBeforeTheRecordIsWithdrawn) {
  FlashChip chip;
  OnFlash run(chip);
  run.idle(70'000);
  run.begin_save(numbered(1));
  for (const unsigned programs = chip.programs; chip.programs == programs;) {
    run.run(10);  // until the log opens a sector
  }
  chip.times.program = 90'000;
  EXPECT_FALSE(run.end_save());
  chip.times.program = 400;
  run.run(2'000'000);
  run.idle(2'000'000);
  EXPECT_TRUE(run.keeper().certain());
  for (unsigned i = 0; i < kPlaces; ++i) {
    ASSERT_TRUE(run.save(numbered(i)));
    run.idle(1'000);
  }
}

TEST(RecordLog, IfOpeningASectorTakesTooLongTheSaveFailsAndALaterOneSucceeds) {
  FlashChip chip = settled();
  OnFlash run(chip);
  chip.times.program = 90'000;
  EXPECT_FALSE(run.save(numbered(1)));
  EXPECT_TRUE(run.keeper().certain());
  run.idle(100'000);
  chip.times.program = 400;
  ASSERT_TRUE(run.save(numbered(2)));
  EXPECT_TRUE(loaded(chip) == numbered(2));
}

// The sequence of a save must be later than that of a record that could not be read at reset.
TEST(RecordLog, ASaveAfterAResetDuringWhichTheFlashDidNotAnswerCounts) {
  FlashChip chip = settled();
  for (unsigned i = 1; i <= 5; ++i) {
    ASSERT_TRUE(OnFlash(chip).save(numbered(i)));
  }
  chip.hangs = true;
  OnFlash run(chip);
  EXPECT_EQ(run.source(), SettingsSource::NoneGood);
  EXPECT_FALSE(run.save(numbered(6)));
  EXPECT_LE(run.latency, Log::kLongestLoad.microseconds() + 2'000);
  chip.hangs = false;
  run.idle(3'000'000);
  EXPECT_TRUE(loaded(chip) == numbered(5)) << "a failed command must not replace the user's settings";
  EXPECT_TRUE(run.save(numbered(7)));
  EXPECT_TRUE(run.keeper().certain());
  EXPECT_TRUE(loaded(chip) == numbered(7));
}

}  // namespace
}  // namespace ex9000::hal::flash
