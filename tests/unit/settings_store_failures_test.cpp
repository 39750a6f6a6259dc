// Saves that the memory does not take: wire.md section 8. "A reply means that it is stored."
#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>

#include "firmware/settings/store.hpp"
#include "tests/unit/settings_store_bench.hpp"

namespace ex9000 {
namespace {

TEST(SettingsStore, AWriteThatReadsBackDifferentlyIsTriedUpToThreeTimes) {
  for (std::size_t noisy = 1; noisy < kAttempts; ++noisy) {
    FakeMemory memory;
    Boot run(memory);
    memory.noisy_reads = noisy;
    EXPECT_TRUE(run.save(numbered(1)));
    EXPECT_EQ(memory.writes.size(), noisy + 1);
    EXPECT_TRUE(Boot(memory).stored() == numbered(1));
  }
}

TEST(SettingsStore, AWriteThatIsNotAnsweredIsTriedUpToThreeTimes) {
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

TEST(SettingsStore, AFailedSaveIsTriedThreeTimesAndThenMadeInvalid) {
  FakeMemory memory;
  Boot run(memory);
  memory.noisy_reads = kAttempts;
  EXPECT_FALSE(run.save(numbered(1)));
  EXPECT_EQ(memory.writes.size(), kAttempts + 1);
  EXPECT_TRUE(run.stored() == factory());
  EXPECT_TRUE(Boot(memory).stored() == factory());
}

TEST(SettingsStore, AFailedSaveDoesNotEndUnreadable) {
  FakeMemory memory;
  put(memory, 0, numbered(5), 7);
  corrupt(memory, 0);
  Boot run(memory);
  memory.unanswered_writes = kAttempts + 1;
  EXPECT_FALSE(run.save(numbered(1)));
  EXPECT_EQ(run.found(), Found::Unreadable);
}

TEST(SettingsStore, ASaveBehindAFailedOneSucceeds) {
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

TEST(SettingsStore, AFailedSaveDoesNotTouchTheCopyThatHoldsTheOldSettings) {
  FakeMemory memory;
  put(memory, 0, numbered(5), 7);
  Boot run(memory);
  memory.noisy_reads = kAttempts;
  EXPECT_FALSE(run.save(numbered(1)));
  for (const std::uint16_t address : memory.writes) {
    EXPECT_NE(address / kPage, copies()[0] / kPage);
  }
}

}  // namespace
}  // namespace ex9000
