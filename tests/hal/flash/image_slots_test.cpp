// Tests the image slots, alone and together with the log of the settings in the same flash. The chip's model
// fails the test if the two use the flash at the same time.
#include "hal/flash/image_slots.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "tests/hal/flash/flash_bench.hpp"

namespace ex9000::hal::flash {
namespace {

using update::kBlockSize;
using update::kSector;
using update::kSlotSize;
using update::SlotJob;
using Slots = ImageSlots<Log, FlashChip::kSlots>;
using Block = std::vector<std::uint8_t>;

constexpr std::uint64_t kMillisecond = 1'000;

SlotJob erase(unsigned slot, std::uint32_t offset) {
  return {SlotJob::Kind::Erase, static_cast<std::uint8_t>(slot), offset, {}, {}};
}
SlotJob program(unsigned slot, std::uint32_t offset, const Block& source) {
  return {
      SlotJob::Kind::Program, static_cast<std::uint8_t>(slot), offset, {source.data(), source.size()}, {}};
}
SlotJob read(unsigned slot, std::uint32_t offset, Block& destination) {
  return {SlotJob::Kind::Read,
          static_cast<std::uint8_t>(slot),
          offset,
          {},
          {destination.data(), destination.size()}};
}

Block block(std::uint_fast32_t seed) {
  Block bytes(kBlockSize);
  std::mt19937 random(seed);
  std::generate(bytes.begin(), bytes.end(), [&] { return static_cast<std::uint8_t>(random()); });
  return bytes;
}

/// A main loop with both users of the flash, from a reset on.
class Flashes {
 public:
  explicit Flashes(FlashChip& chip) : chip_(chip), settings(chip), slots(settings.log()) {}

  /// Until the job has ended. Returns its duration in us, or fails the test after 10 s.
  std::uint64_t complete(const SlotJob& job) {
    const std::uint64_t began = chip_.now;
    slots.start(job, chip_.time());
    while (slots.busy() && !testing::Test::HasFailure()) {
      pass();
      EXPECT_LT(chip_.now, began + 10'000 * kMillisecond);
    }
    return chip_.now - began;
  }

  /// Saves while the slots do what they do. Returns the duration in us.
  std::uint64_t save(unsigned number) {
    const std::uint64_t began = chip_.now;
    settings.begin_save(numbered(number));
    while (settings.log().busy()) {
      pass();
    }
    settings.keeper().done(settings.log().result());
    saved = settings.keeper().saved();
    return chip_.now - began;
  }

  void run(std::uint64_t microseconds) {
    for (const std::uint64_t end = chip_.now + microseconds; chip_.now < end;) {
      pass();
    }
  }

  /// A pass takes 10 us; the main loop sleeps at most 1 ms.
  void pass() {
    constexpr std::uint64_t kPass = 10;
    constexpr int kMostPasses = 1'000;
    int passes = 0;
    for (bool again = true; again;) {
      again = settings.log().poll(chip_.time());
      again = slots.poll(chip_.time()) || again;
      chip_.run(kPass);
      ASSERT_LT(++passes, kMostPasses) << "the main loop does not sleep";
    }
    chip_.run(kMemoryPollPeriod.microseconds() - kPass);
  }

 private:
  FlashChip& chip_;

 public:
  OnFlash settings;
  Slots slots;
  bool saved = false;
};

FlashChip with_slots(const FlashChip::Times& times = {}) {
  FlashChip chip = settled(times);
  chip.add_slots();
  return chip;
}

TEST(ImageSlots, KnowTheHeadsOfBothSlotsAtTheReset) {
  FlashChip chip = with_slots();
  chip.slots()[0] = 'A';
  chip.slots()[kSlotSize + update::kSlotHeadSize - 1] = 'B';
  Flashes flashes(chip);
  flashes.slots.begin(1, "pico");
  const update::Origin& origin = flashes.slots.origin();
  EXPECT_EQ(origin.slot, 1);
  EXPECT_EQ(origin.board, "pico");
  EXPECT_EQ(origin.heads[0][0], 'A');
  EXPECT_EQ(origin.heads[1].size, update::kSlotHeadSize);
  EXPECT_EQ(origin.heads[1][update::kSlotHeadSize - 1], 'B');
}

TEST(ImageSlots, EraseProgramAndRead) {
  FlashChip chip = with_slots();
  std::fill_n(chip.slots(), 2 * kSlotSize, std::uint8_t{0});
  Flashes flashes(chip);
  flashes.run(100 * kMillisecond);
  for (const unsigned slot : {0U, 1U}) {
    const std::uint32_t last = kSlotSize - kSector;
    flashes.complete(erase(slot, last));
    const std::uint8_t* const sector = chip.slots() + slot * kSlotSize + last;
    EXPECT_TRUE(std::all_of(sector, sector + kSector, [](std::uint8_t byte) { return byte == 0xFF; }));
    EXPECT_EQ(sector[-1], 0);
    const Block written = block(slot);
    const std::uint32_t at = last + 3 * kBlockSize;
    flashes.complete(program(slot, at, written));
    Block found(kBlockSize);
    EXPECT_LE(flashes.complete(read(slot, at, found)), 2 * kMillisecond);
    EXPECT_EQ(found, written);
    EXPECT_FALSE(flashes.slots.poll(chip.time()));
  }
}

/// The longest time from a command until its settings are saved. With 3 ms for a program operation, a save
/// takes up to 8 ms (record_log.hpp).
TEST(ImageSlots, ASaveWaitsForAtMostOneProgramOperationOrTheShortestErase) {
  constexpr std::uint64_t kLongestAlone = 8 * kMillisecond;
  constexpr std::uint64_t kAdded = 3 * kMillisecond;
  const Block written = block(1);
  for (const SlotJob& job : {erase(1, 0), program(1, 0, written)}) {
    for (std::uint64_t before = 0; before < 20 * kMillisecond; before += 170) {
      SCOPED_TRACE(before);
      FlashChip chip = with_slots(FlashChip::kLongest);
      Flashes flashes(chip);
      flashes.run(50 * kMillisecond);
      flashes.slots.start(job, chip.time());
      flashes.slots.poll(chip.time());
      chip.run(before % kMillisecond);
      flashes.run(before - before % kMillisecond);
      EXPECT_LE(flashes.save(7), kLongestAlone + kAdded);
      EXPECT_TRUE(flashes.saved);
      flashes.run(450 * kMillisecond);
      EXPECT_FALSE(flashes.slots.busy());
      EXPECT_FALSE(chip.erase_suspended());
      EXPECT_TRUE(OnFlash(chip).stored() == numbered(7));
    }
  }
}

TEST(ImageSlots, AnEraseEndsAlthoughSettingsAreSavedAllTheTime) {
  FlashChip chip = with_slots(FlashChip::kLongest);
  Flashes flashes(chip);
  flashes.run(50 * kMillisecond);
  flashes.slots.start(erase(1, kSector), chip.time());
  unsigned saves = 0;
  for (; flashes.slots.busy(); flashes.run(kMillisecond)) {
    flashes.save(++saves);
    ASSERT_TRUE(flashes.saved) << saves;
    ASSERT_LT(saves, 400U);
  }
  EXPECT_GT(saves, 100U);
}

/// The log must not erase a sector while the erase of a slot is suspended.
TEST(ImageSlots, ASaveWithoutAnErasedSectorLeavesTheFlashToTheErase) {
  FlashChip chip = with_slots({4'000 * kMillisecond, 400});
  Flashes flashes(chip);
  flashes.run(50 * kMillisecond);
  flashes.slots.start(erase(1, kSector), chip.time());
  unsigned saves = 0;
  for (; flashes.saved || saves == 0; flashes.run(kMillisecond)) {
    EXPECT_LE(flashes.save(++saves), Log::kLongestSave.microseconds() + 2 * kMillisecond);
  }
  EXPECT_GT(saves, 400U) << "the log has room for more";
  EXPECT_TRUE(flashes.slots.busy());
  EXPECT_TRUE(chip.busy());
  chip.times = {};
  flashes.run(5'000 * kMillisecond);
  EXPECT_FALSE(flashes.slots.busy());
  flashes.save(1);
  EXPECT_TRUE(flashes.saved);
}

/// The log of a new module erases its sectors first.
TEST(ImageSlots, WaitForTheErasesOfTheLog) {
  FlashChip chip;
  chip.add_slots();
  Flashes flashes(chip);
  flashes.slots.start(erase(1, 0), chip.time());
  flashes.run(13 * 45 * kMillisecond);
  EXPECT_TRUE(flashes.slots.busy());
  flashes.run(3 * 45 * kMillisecond);
  EXPECT_FALSE(flashes.slots.busy());
  EXPECT_EQ(chip.operations().back(), FlashChip::Operation::Erase);
}

TEST(ImageSlots, AResetLeavesAnEraseThatTheNextStartCompletes) {
  for (const bool suspended : {false, true}) {
    for (const bool bad_records : {false, true}) {
      FlashChip chip = with_slots();
      if (bad_records) {
        std::fill_n(&chip.cells[kRecordRoom], 16, std::uint8_t{0x12});
        std::fill_n(chip.cells.begin(), 8, std::uint8_t{0});
      }
      std::fill_n(chip.slots(), kSector, std::uint8_t{0});
      {
        Flashes flashes(chip);
        flashes.run(50 * kMillisecond);
        flashes.slots.start(erase(0, 0), chip.time());
        flashes.run(10 * kMillisecond);
        if (suspended) {
          flashes.settings.begin_save(numbered(3));
          while (!chip.erase_suspended()) {
            flashes.settings.log().poll(chip.time());
            flashes.slots.poll(chip.time());
            chip.run(10);
          }
        }
      }
      if (suspended) {
        chip.resume();  // as at the start of the driver
      }
      Flashes flashes(chip);
      EXPECT_LE(flashes.settings.latency, Log::kLongestLoad.microseconds());
      flashes.complete(erase(1, 0));
      EXPECT_EQ(*chip.slots(), 0xFF) << "suspended: " << suspended << ", bad records: " << bad_records;
    }
  }
}

TEST(ImageSlots, SavesFailInTimeIfTheFlashNeverAnswers) {
  const Block written = block(1);
  for (const SlotJob& job : {erase(1, 0), program(1, 0, written)}) {
    for (const std::uint64_t before : {500U, 1'500U, 5'000U}) {
      FlashChip chip = with_slots();
      Flashes flashes(chip);
      flashes.run(50 * kMillisecond);
      flashes.slots.start(job, chip.time());
      flashes.slots.poll(chip.time());
      chip.hangs = true;
      chip.run(before);
      EXPECT_LE(flashes.save(7), Log::kLongestSave.microseconds() + 2 * kMillisecond);
      EXPECT_FALSE(flashes.saved);
      EXPECT_TRUE(flashes.slots.busy());
      flashes.run(100 * kMillisecond);
      chip.hangs = false;
      flashes.run(100 * kMillisecond);
      EXPECT_FALSE(flashes.slots.busy());
      flashes.save(8);
      EXPECT_TRUE(flashes.saved);
    }
  }
}

/// An erase can end in any phase of a suspension.
TEST(ImageSlots, AnyMixtureOfJobsAndSavesKeepsTheRulesOfTheFlash) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    std::mt19937 random(seed);
    FlashChip chip = with_slots({1'000 + random() % 5'000, 100 + random() % 2'900});
    Flashes flashes(chip);
    Block written;
    for (unsigned i = 0; i < 300; ++i) {
      if (!flashes.slots.busy()) {
        const unsigned sector = 1 + random() % 4;
        written = block(random());
        flashes.complete(erase(1, sector * kSector));
        flashes.slots.start(program(1, sector * kSector, written), chip.time());
      }
      if (random() % 2 == 0) {
        flashes.save(i);
        ASSERT_TRUE(flashes.saved);
      }
      chip.run(random() % 1'500);
      flashes.pass();
      ASSERT_FALSE(HasFailure());
    }
  }
}

TEST(ImageSlots, HaveTheFlashForThemselvesIfTheSettingsAreElsewhere) {
  FlashChip chip = with_slots();
  NoLog<FlashPort> no_log;
  no_log.flash().chip = &chip;
  ImageSlots<NoLog<FlashPort>, FlashChip::kSlots> slots(no_log);
  slots.begin(0, "pice");
  *chip.slots() = 0;
  slots.start(erase(0, 0), chip.time());
  EXPECT_FALSE(slots.poll(chip.time()));
  chip.run(44 * kMillisecond);
  EXPECT_FALSE(slots.poll(chip.time()));
  EXPECT_TRUE(slots.busy());
  chip.run(2 * kMillisecond);
  EXPECT_TRUE(slots.poll(chip.time()));
  EXPECT_FALSE(slots.busy());
  EXPECT_EQ(*chip.slots(), 0xFF);
  EXPECT_EQ(slots.origin().heads[0][0], 0xFF) << "as at the reset";
}

}  // namespace
}  // namespace ex9000::hal::flash
