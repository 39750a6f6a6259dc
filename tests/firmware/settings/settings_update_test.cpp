// Tests the settings store after a change of the firmware. In most tests, the memory contains copies of an
// older layout, or a record that is longer than this firmware would write.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/firmware/settings/settings_store_bench.hpp"

namespace ex9000 {
namespace {

/// Returns a memory after an update: two copies of layout 2, of which the second is newer.
FakeMemory updated() {
  FakeMemory memory;
  put_old(memory, 0, numbered(5), 7);
  put_old(memory, 1, numbered(6), 8);
  return memory;
}

void expect_no_old_copy_counts(const FakeMemory& memory) {
  FakeMemory old = memory;
  std::fill(old.cells.begin() + kCopies[0], old.cells.end(), std::uint8_t{0x00});
  EXPECT_EQ(Boot(old).found(), Found::Unreadable);
}

TEST(SettingsAfterAnUpdate, AreThoseOfTheNewerOldCopyAndNothingIsWritten) {
  FakeMemory memory = updated();
  const Boot run(memory);
  EXPECT_EQ(run.found(), Found::Settings);
  EXPECT_TRUE(run.stored() == numbered(6));
  EXPECT_TRUE(memory.writes.empty());
}

TEST(SettingsAfterAnUpdate, AreThoseOfTheOnlyGoodOldCopy) {
  for (const std::size_t bad : {0U, 1U}) {
    FakeMemory memory = updated();
    memory.cells[kOldCopies[bad] + 3U] ^= 0x40U;
    EXPECT_TRUE(Boot(memory).stored() == numbered(bad == 0 ? 6 : 5));
  }
}

TEST(SettingsAfterAnUpdate, AreUnreadableIfBothOldCopiesAreCorrupted) {
  FakeMemory memory = updated();
  memory.cells[kOldCopies[0] + 3U] ^= 0x40U;
  memory.cells[kOldCopies[1] + 3U] ^= 0x40U;
  EXPECT_EQ(Boot(memory).found(), Found::Unreadable);
}

TEST(SettingsAfterAnUpdate, TheFirstSaveMakesANewCopyAndInvalidatesTheOldOnes) {
  FakeMemory memory = updated();
  EXPECT_TRUE(Boot(memory).save(numbered(9)));
  EXPECT_EQ(memory.writes,
            (std::vector<std::uint16_t>{kCopies[0], static_cast<std::uint16_t>(kOldCopies[0] + 20),
                                        static_cast<std::uint16_t>(kOldCopies[1] + 20)}));
  EXPECT_TRUE(Boot(memory).stored() == numbered(9));
  expect_no_old_copy_counts(memory);
}

TEST(SettingsAfterAnUpdate, TheSecondSaveWritesOnlyTheOtherNewPlace) {
  FakeMemory memory = updated();
  EXPECT_TRUE(Boot(memory).save(numbered(9)));
  memory.writes.clear();
  EXPECT_TRUE(Boot(memory).save(numbered(10)));
  EXPECT_EQ(memory.writes, std::vector<std::uint16_t>{kCopies[1]});
  EXPECT_TRUE(Boot(memory).stored() == numbered(10));
}

TEST(SettingsAfterAnUpdate, OldCopiesAreNeverUsedAgainEvenIfAllNewCopiesFail) {
  FakeMemory memory = updated();
  Boot run(memory);
  EXPECT_TRUE(run.save(numbered(9)));
  EXPECT_TRUE(run.save(numbered(10)));
  corrupt(memory, 0);
  corrupt(memory, 1);
  const Boot next(memory);
  EXPECT_EQ(next.found(), Found::Unreadable);
  EXPECT_TRUE(next.stored() == factory());
}

TEST(SettingsAfterAnUpdate, IfTheFirstSaveFailsTheOldCopiesStayValid) {
  for (std::size_t failure = 0; failure < kFailures.size(); ++failure) {
    FakeMemory memory = updated();
    Boot run(memory);
    kFailures[failure](memory);
    EXPECT_FALSE(run.save(numbered(9))) << failure;
    EXPECT_TRUE(run.stored() == numbered(6)) << failure;
    EXPECT_TRUE(Boot(memory).stored() == numbered(6)) << failure;
  }
}

// The power failed after the new copy was written, and perhaps verified, but before the old copies were
// invalidated.
TEST(SettingsAfterAnUpdate, OldCopiesStayValidUntilTheSettingsAreSavedAgain) {
  FakeMemory memory = updated();
  put(memory, 0, numbered(9), 9);
  SettingsStore store(the_model());
  drive(store, memory);
  EXPECT_TRUE(store.stored() == numbered(9));
  EXPECT_TRUE(memory.writes.empty());
  EXPECT_FALSE(store.needs_invalidation());
  ASSERT_TRUE(store.update_unfinished());
  store.begin_saving(store.stored());
  drive(store, memory);
  EXPECT_TRUE(store.saved());
  EXPECT_FALSE(store.needs_invalidation());
  EXPECT_FALSE(store.update_unfinished());
  expect_no_old_copy_counts(memory);
  EXPECT_TRUE(Boot(memory).stored() == numbered(9));
}

TEST(SettingsAfterAnUpdate, NothingIsUnfinishedBeforeTheFirstSave) {
  FakeMemory memory = updated();
  SettingsStore store(the_model());
  drive(store, memory);
  EXPECT_FALSE(store.update_unfinished());
}

TEST(SettingsAfterAnUpdate, NothingIsUnfinishedInAMemoryWithoutACopy) {
  FakeMemory memory;
  SettingsStore store(the_model());
  drive(store, memory);
  EXPECT_FALSE(store.update_unfinished());
}

// The power failure left too little charge in the memory cells of the new copy, so the copy can be read only
// once.
TEST(SettingsAfterAnUpdate, OldCopiesAreUsedIfTheNewCopyBecomesUnreadableBeforeTheSettingsAreSavedAgain) {
  FakeMemory memory = updated();
  put(memory, 0, numbered(9), 9);
  SettingsStore store(the_model());
  drive(store, memory);
  ASSERT_TRUE(store.update_unfinished());
  corrupt(memory, 0);
  EXPECT_TRUE(Boot(memory).stored() == numbered(6));
}

// The second place for copies of layout 3 cannot be written. The old copies must not be used again even if
// the new copy becomes unreadable later.
TEST(SettingsAfterAnUpdate, OldCopiesAreInvalidatedIfTheSettingsCannotBeSavedAgain) {
  FakeMemory memory = updated();
  put(memory, 0, numbered(9), 9);
  SettingsStore store(the_model());
  drive(store, memory);
  memory.unanswered_writes = 3;
  store.begin_saving(store.stored());
  drive(store, memory);
  EXPECT_FALSE(store.saved());
  EXPECT_FALSE(store.update_unfinished());
  EXPECT_FALSE(store.needs_invalidation());
  expect_no_old_copy_counts(memory);
  EXPECT_TRUE(Boot(memory).stored() == numbered(9));
}

// The memory did not answer at reset, so the factory settings are in force. The module must not store them in
// order to finish the update.
TEST(SettingsAfterAnUpdate, NothingIsUnfinishedWhileTheSettingsAreUnreadable) {
  FakeMemory memory = updated();
  put(memory, 0, numbered(9), 9);
  memory.failing_reads = kReadsOfASilentMemory;
  SettingsStore store(the_model());
  drive(store, memory);
  ASSERT_EQ(store.found(), Found::Unreadable);
  memory.unanswered_writes = 4;
  store.begin_saving(numbered(10));
  drive(store, memory);
  EXPECT_FALSE(store.saved());
  EXPECT_FALSE(store.update_unfinished());
  EXPECT_TRUE(Boot(memory).stored() == numbered(9));
}

TEST(SettingsAfterAnUpdate, InvalidatingAnOldCopyCanBeRepeated) {
  FakeMemory memory = updated();
  SettingsStore store(the_model());
  drive(store, memory);
  store.begin_saving(numbered(9));
  // Two jobs write and verify the new copy. Then the memory does not answer the next three writes.
  for (int jobs = 0; jobs < 2; ++jobs) {
    store.done(*memory.run(store.job()));
  }
  memory.unanswered_writes = 3;
  drive(store, memory);
  EXPECT_TRUE(store.saved());
  ASSERT_TRUE(store.needs_invalidation());
  store.begin_invalidating();
  drive(store, memory);
  EXPECT_TRUE(store.needs_invalidation());  // one of the two old copies is still valid
  store.begin_invalidating();
  drive(store, memory);
  EXPECT_FALSE(store.needs_invalidation());
  expect_no_old_copy_counts(memory);
}

TEST(SettingsAfterAnUpdate, ANewCopyWithAnySequenceNumberIsUsedInsteadOfOldCopies) {
  for (const unsigned sequence : {0U, 1U, 0x7FFFU, 0x8000U, 0xFFFFU}) {
    FakeMemory memory = updated();
    put(memory, 1, numbered(9), static_cast<std::uint16_t>(sequence));
    EXPECT_TRUE(Boot(memory).stored() == numbered(9)) << sequence;
  }
}

TEST(SettingsAfterAnUpdate, OldCopiesAreNotUsedAfterASaveEvenIfTheMemoryDidNotAnswerAtReset) {
  FakeMemory memory = updated();
  memory.failing_reads = kReadsOfASilentMemory;
  Boot run(memory);
  ASSERT_EQ(run.found(), Found::Unreadable);
  EXPECT_TRUE(run.save(numbered(9)));
  EXPECT_TRUE(Boot(memory).stored() == numbered(9));
  expect_no_old_copy_counts(memory);
}

// --- a record that is longer than this firmware expects ---

TEST(ALongerRecord, IsReadUpToTheLastKnownSetting) {
  for (unsigned length = 20; length <= 120; ++length) {
    FakeMemory memory;
    put_longer(memory, 0, numbered(5), 7, static_cast<std::uint8_t>(length));
    const Boot run(memory);
    EXPECT_EQ(run.found(), Found::Settings) << length;
    EXPECT_TRUE(run.stored() == numbered(5)) << length;
  }
}

TEST(ALongerRecord, KeepsUnknownSettingsAfterEachSave) {
  for (unsigned length = kSupportedSettings + 1; length <= 120; ++length) {
    FakeMemory memory;
    put_longer(memory, 0, numbered(5), 7, static_cast<std::uint8_t>(length));
    Boot run(memory);
    for (unsigned store = 0; store < 3; ++store) {
      ASSERT_TRUE(run.save(numbered(10 + store))) << length;
    }
    FakeMemory expected;
    put_longer(expected, 1, numbered(12), 10, static_cast<std::uint8_t>(length));
    const auto copy = [length](const FakeMemory& of) {
      const auto begin = of.cells.begin() + kCopies[1];
      return std::vector<std::uint8_t>(begin, begin + 4 + static_cast<std::ptrdiff_t>(length) + 4);
    };
    EXPECT_EQ(copy(memory), copy(expected)) << length;
    EXPECT_TRUE(Boot(memory).stored() == numbered(12)) << length;
  }
}

TEST(ALongerRecord, KeepsUnknownSettingsAfterAFailedSave) {
  FakeMemory memory;
  put_longer(memory, 0, numbered(5), 7, 96);
  Boot run(memory);
  memory.noisy_reads = kAttempts;
  EXPECT_FALSE(run.save(numbered(6)));
  EXPECT_TRUE(Boot(memory).stored() == numbered(5));
  EXPECT_TRUE(run.save(numbered(7)));
  FakeMemory expected;
  put_longer(expected, 1, numbered(7), 8, 96);
  EXPECT_TRUE(std::equal(memory.cells.begin() + kCopies[1], memory.cells.begin() + kCopies[1] + 104,
                         expected.cells.begin() + kCopies[1]));
}

TEST(ALongerRecord, IsWrittenPageByPageAndOnlyUpToItsEnd) {
  FakeMemory memory;
  put_longer(memory, 0, numbered(5), 7, 96);  // 104 bytes
  EXPECT_TRUE(Boot(memory).save(numbered(6)));
  EXPECT_EQ(memory.writes, (std::vector<std::uint16_t>{0x100, 0x120, 0x140, 0x160}));
  memory.writes.clear();
  FakeMemory shorter;
  put_longer(shorter, 0, numbered(5), 7, 56);  // 64 bytes
  EXPECT_TRUE(Boot(shorter).save(numbered(6)));
  EXPECT_EQ(shorter.writes, (std::vector<std::uint16_t>{0x100, 0x120}));
}

TEST(ALongerRecord, IsInvalidIfAnyByteIsWrong) {
  FakeMemory good;
  put_longer(good, 0, numbered(5), 7, 96);
  put(good, 1, numbered(6), 6);
  for (std::size_t at = 0; at < 104; ++at) {
    FakeMemory memory = good;
    memory.cells[kCopies[0] + at] ^= 0x04U;
    EXPECT_TRUE(Boot(memory).stored() == numbered(6)) << at;
  }
}

TEST(ALongerRecord, IsRefusedIfOnePageFailsThreeTimesAndTheOldRecordStays) {
  for (std::size_t page = 0; page < 4; ++page) {
    FakeMemory memory;
    put_longer(memory, 0, numbered(5), 7, 96);
    SettingsStore store(the_model());
    drive(store, memory);
    store.begin_saving(numbered(6));
    for (std::size_t jobs = 0; jobs < 2 * page; ++jobs) {
      store.done(*memory.run(store.job()));
    }
    memory.unanswered_writes = kAttempts;
    drive(store, memory);
    EXPECT_FALSE(store.saved()) << page;
    EXPECT_TRUE(Boot(memory).stored() == numbered(5)) << page;
  }
}

}  // namespace
}  // namespace ex9000
