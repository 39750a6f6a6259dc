// Tests saves during which the memory fails: wire.md section 8, "A valid reply means that the settings are
// stored."
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "firmware/settings/store.hpp"
#include "tests/firmware/settings/settings_store_bench.hpp"

namespace ex9000 {
namespace {

TEST(SettingsStore, IfTheReadBackDiffersOnceOrTwiceTheWriteIsRepeated) {
  for (std::size_t noisy = 1; noisy < kAttempts; ++noisy) {
    FakeMemory memory;
    Boot run(memory);
    memory.noisy_reads = noisy;
    EXPECT_TRUE(run.save(numbered(1)));
    EXPECT_EQ(memory.writes.size(), noisy + 1);
    EXPECT_TRUE(Boot(memory).stored() == numbered(1));
  }
}

TEST(SettingsStore, IfAWriteIsNotAnsweredOnceOrTwiceItIsRepeated) {
  for (std::size_t unanswered = 1; unanswered < kAttempts; ++unanswered) {
    FakeMemory memory;
    Boot run(memory);
    memory.unanswered_writes = unanswered;
    EXPECT_TRUE(run.save(numbered(1)));
    EXPECT_EQ(memory.writes.size(), unanswered + 1);
    EXPECT_TRUE(Boot(memory).stored() == numbered(1));
  }
}

TEST(SettingsStore, AReadBackThatIsNotAnsweredIsAFailedAttemptToo) {
  FakeMemory memory;
  Boot run(memory);
  memory.failing_reads = kAttempts - 1;
  EXPECT_TRUE(run.save(numbered(1)));
  EXPECT_EQ(memory.writes.size(), kAttempts);
}

TEST(SettingsStore, AfterThreeFailedAttemptsTheOldSettingsStayAndAreFoundAtTheNextLoad) {
  for (std::size_t failure = 0; failure < kFailures.size(); ++failure) {
    FakeMemory memory;
    Boot first(memory);
    ASSERT_TRUE(first.save(numbered(1)));
    ASSERT_TRUE(first.save(numbered(2)));
    Boot run(memory);
    memory.writes.clear();
    kFailures[failure](memory);
    EXPECT_FALSE(run.save(numbered(3))) << failure;
    EXPECT_TRUE(run.stored() == numbered(2)) << failure;
    EXPECT_TRUE(Boot(memory).stored() == numbered(2)) << failure;
  }
}

TEST(SettingsStore, AfterThreeFailedAttemptsTheNewCopyIsInvalidated) {
  FakeMemory memory;
  Boot run(memory);
  memory.noisy_reads = kAttempts;
  EXPECT_FALSE(run.save(numbered(1)));
  EXPECT_EQ(memory.writes.size(), kAttempts + 1);
  EXPECT_TRUE(run.stored() == factory());
  EXPECT_TRUE(Boot(memory).stored() == factory());
}

TEST(SettingsStore, AfterAFailedSaveUnreadableSettingsStayUnreadable) {
  FakeMemory memory;
  put(memory, 0, numbered(5), 7);
  corrupt(memory, 0);
  Boot run(memory);
  memory.unanswered_writes = kAttempts + 1;
  EXPECT_FALSE(run.save(numbered(1)));
  EXPECT_EQ(run.found(), Found::Unreadable);
}

TEST(SettingsStore, ASaveAfterAFailedSaveSucceeds) {
  for (const auto fail : kFailures) {
    FakeMemory memory;
    Boot run(memory);
    ASSERT_TRUE(run.save(numbered(1)));
    fail(memory);
    EXPECT_FALSE(run.save(numbered(2)));
    memory.stuck = false;
    EXPECT_TRUE(run.save(numbered(3)));
    EXPECT_TRUE(run.stored() == numbered(3));
    EXPECT_TRUE(Boot(memory).stored() == numbered(3));
  }
}

TEST(SettingsStore, AFailedSaveDoesNotWriteTheCopyThatHoldsTheOldSettings) {
  FakeMemory memory;
  put(memory, 0, numbered(5), 7);
  Boot run(memory);
  memory.noisy_reads = kAttempts;
  EXPECT_FALSE(run.save(numbered(1)));
  for (const std::uint16_t address : memory.writes) {
    EXPECT_NE(address / kPage, kCopies[0] / kPage);
  }
}

/// Ends `count` jobs of the store, one after the other. If `answered` is true, the memory answers, and reads
/// return garbage. If `answered` is false, the memory does not answer.
void end_jobs(SettingsStore& store, bool answered, int count) {
  for (int i = 0; i < count; ++i) {
    const MemoryJob job = store.job();
    if (job.kind == MemoryJob::Kind::Read && answered) {
      std::fill_n(job.bytes.data, job.bytes.size, std::uint8_t{0x5A});
    }
    store.done(answered);
  }
}

TEST(SettingsStore, TheCopyOfAFailedSaveIsInvalidatedAndTheCopyThatWasReadLastIsNot) {
  constexpr int kAllReads = 2 * static_cast<int>(kAttempts);
  SettingsStore store(the_model());
  end_jobs(store, false, static_cast<int>(kReadsOfASilentMemory));
  ASSERT_EQ(store.found(), SettingsStore::Found::Unreadable);
  store.begin_saving(numbered(1));
  end_jobs(store, true, kAllReads);  // three reads of each place return garbage
  const std::uint16_t invalidated = store.job().address;
  for (std::size_t attempt = 0; attempt < kAttempts; ++attempt) {
    end_jobs(store, true, 1);   // the write succeeds
    end_jobs(store, false, 1);  // the memory does not answer the read-back
  }
  end_jobs(store, false, 1);  // the memory does not answer the write that invalidates the copy
  ASSERT_TRUE(store.needs_invalidation());

  store.begin_saving(numbered(2));
  end_jobs(store, true, 3);
  end_jobs(store, false, 3);  // the memory does not answer at the second place
  ASSERT_FALSE(store.busy());
  ASSERT_TRUE(store.needs_invalidation());
  store.begin_invalidating();
  EXPECT_EQ(store.job().address / kPage, invalidated / kPage);
  end_jobs(store, true, 2);  // the write, and the read-back
  EXPECT_FALSE(store.needs_invalidation());
}

/// Saves settings, of which `pages_before` pages succeed. The read-back of the next page, the last one,
/// differs each time, so the copy is refused although it is complete. The write that invalidates it has no
/// effect.
void refuse_a_complete_copy(SettingsStore& store, FakeMemory& memory, std::size_t pages_before = 0) {
  store.begin_saving(numbered(21));
  for (std::size_t jobs = 0; jobs < 2 * pages_before; ++jobs) {
    store.done(*memory.run(store.job()));
  }
  memory.noisy_reads = kAttempts;
  memory.ignored_after = kAttempts;
  ASSERT_TRUE(drive(store, memory));
  EXPECT_FALSE(store.saved());
  ASSERT_TRUE(Boot(memory).stored() == numbered(21)) << "the copy is valid, so this test can fail";
}

// A memory that answers a write without doing it must not make refused settings valid.
TEST(SettingsStore, AnInvalidationWithoutEffectIsNoticed) {
  FakeMemory memory;
  put(memory, 0, numbered(1), 7);
  SettingsStore store(the_model());
  ASSERT_TRUE(drive(store, memory));
  refuse_a_complete_copy(store, memory);
  EXPECT_TRUE(store.needs_invalidation());
  store.begin_invalidating();
  ASSERT_TRUE(drive(store, memory));
  EXPECT_TRUE(store.needs_invalidation());

  memory.ignored_after = SIZE_MAX;
  store.begin_invalidating();
  ASSERT_TRUE(drive(store, memory));
  EXPECT_FALSE(store.needs_invalidation());
  EXPECT_TRUE(Boot(memory).stored() == numbered(1));
}

TEST(SettingsStore, AnInvalidationOfSeveralPagesWithoutEffectIsNoticed) {
  FakeMemory memory;
  put_longer(memory, 0, numbered(1), 7, 96);
  SettingsStore store(the_model());
  ASSERT_TRUE(drive(store, memory));
  refuse_a_complete_copy(store, memory, 3);
  EXPECT_TRUE(store.needs_invalidation());
}

TEST(SettingsStore, AnInvalidationWithoutEffectOfTheFirstCopyIsNoticed) {
  FakeMemory memory;
  SettingsStore store(the_model());
  ASSERT_TRUE(drive(store, memory));
  refuse_a_complete_copy(store, memory);
  EXPECT_TRUE(store.needs_invalidation());
}

TEST(SettingsStore, AnInvalidationThatCannotBeReadBackIsRepeated) {
  FakeMemory memory;
  SettingsStore store(the_model());
  ASSERT_TRUE(drive(store, memory));
  memory.noisy_reads = kAttempts;
  store.begin_saving(numbered(21));
  for (std::size_t jobs = 0; jobs < 2 * kAttempts + 1; ++jobs) {  // three attempts, and the invalidation
    store.done(*memory.run(store.job()));
  }
  memory.failing_reads = 1;
  ASSERT_TRUE(drive(store, memory));
  EXPECT_TRUE(store.needs_invalidation());
  store.begin_invalidating();
  ASSERT_TRUE(drive(store, memory));
  EXPECT_FALSE(store.needs_invalidation());
}

// A worn cell that keeps its value does not make the copy valid, so it is not written again and again.
TEST(SettingsStore, AnInvalidationThatIsIncompleteButSufficientIsNotRepeated) {
  FakeMemory memory;
  Boot run(memory);
  ASSERT_TRUE(run.save(numbered(1)));
  SettingsStore store(the_model());
  ASSERT_TRUE(drive(store, memory));
  memory.noisy_reads = kAttempts;
  memory.stuck = true;
  store.begin_saving(numbered(21));
  ASSERT_TRUE(drive(store, memory));
  EXPECT_FALSE(store.saved());
  EXPECT_FALSE(store.needs_invalidation());
  EXPECT_TRUE(Boot(memory).stored() == numbered(1));
}

// The memory did not answer at reset. Then a save failed, and its copy could not be invalidated. The next
// save reads all copies again.
TEST(SettingsStore, RefusedSettingsAreNotUsedWhenAllCopiesAreReadAgain) {
  FakeMemory memory;
  put(memory, 0, numbered(5), 7);
  memory.failing_reads = kReadsOfASilentMemory;
  Boot run(memory);
  ASSERT_EQ(run.found(), Found::Unreadable);
  memory.unanswered_writes = kAttempts + 1;
  // The memory carries out these writes but does not answer them. First it stores the refused settings. Then
  // it stores the zeros that invalidate this copy.
  memory.unanswered_but_done = true;
  EXPECT_FALSE(run.save(numbered(6)));
  put(memory, 1, numbered(6), 8);  // as if the invalidating write had not been done
  memory.writes.clear();
  memory.unanswered_writes = kAttempts;
  memory.unanswered_but_done = false;
  EXPECT_FALSE(run.save(numbered(9)));
  for (const std::uint16_t address : memory.writes) {
    EXPECT_NE(address, kCopies[0]) << "a write to the only copy without refused settings";
  }
  EXPECT_TRUE(Boot(memory).stored() == numbered(5));
}

}  // namespace
}  // namespace ex9000
