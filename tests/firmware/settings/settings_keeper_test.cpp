// Tests that SettingsKeeper stores changed settings, invalidates refused copies and
// retries after a failure: wire.md section 8, D6 and D15.
#include "firmware/settings/settings_keeper.hpp"

#include <gtest/gtest.h>

#include "tests/firmware/settings/settings_store_bench.hpp"

namespace ex9000 {
namespace {

class SettingsKeeperTest : public testing::Test {
 protected:
  SettingsKeeperTest() { drive_memory(); }

  /// Runs all memory jobs of the keeper.
  void drive_memory() {
    for (int jobs = 0; keeper_.busy(); ++jobs) {
      ASSERT_LT(jobs, 100) << "the keeper is still busy after 100 jobs";
      const MemoryJob job = keeper_.job();
      keeper_.done(memory_.run(job).value_or(false));
    }
  }
  void store(const Settings& settings) {
    keeper_.save(settings, now_);
    drive_memory();
  }
  void pass(Duration time) { now_ = now_ + time; }
  [[nodiscard]] std::size_t writes() const { return memory_.writes.size(); }

  FakeMemory memory_;
  SettingsKeeper keeper_{the_model()};
  Time now_{1000};
};

TEST(SettingsKeeperAtReset, IsLoadingAndBusyAtFirst) {
  FakeMemory memory;
  SettingsKeeper keeper(the_model());
  EXPECT_TRUE(keeper.loading());
  EXPECT_TRUE(keeper.busy());
}

TEST_F(SettingsKeeperTest, ABlankMemoryMeansFactorySettingsAndIsNotUnreadable) {
  EXPECT_FALSE(keeper_.loading());
  EXPECT_FALSE(keeper_.unreadable());
  EXPECT_TRUE(keeper_.stored() == factory());
}

TEST_F(SettingsKeeperTest, WritesNothingWhileTheSettingsEqualTheStoredSettings) {
  keeper_.poll(keeper_.stored(), now_);
  EXPECT_FALSE(keeper_.busy());
  keeper_.settings_changed();  // the settings have changed and changed back
  keeper_.poll(keeper_.stored(), now_);
  EXPECT_FALSE(keeper_.busy());
  EXPECT_EQ(writes(), 0U);
}

TEST_F(SettingsKeeperTest, StoresTheSettingsOfACommand) {
  store(numbered(5));
  EXPECT_TRUE(keeper_.saved());
  EXPECT_TRUE(keeper_.stored() == numbered(5));
  keeper_.poll(numbered(5), now_);
  EXPECT_FALSE(keeper_.busy());
  EXPECT_EQ(writes(), 1U);
}

TEST_F(SettingsKeeperTest, StoresAChangeWithoutACommand) {
  keeper_.settings_changed();
  keeper_.poll(numbered(5), now_);
  EXPECT_TRUE(keeper_.busy());
  drive_memory();
  keeper_.poll(numbered(5), now_);
  EXPECT_TRUE(keeper_.stored() == numbered(5));
  EXPECT_FALSE(keeper_.retry().armed());
}

// wire.md D6: the host watchdog expires while a command is stored.
TEST_F(SettingsKeeperTest, StoresAChangeThatOccursWhileACommandIsStored) {
  store(numbered(5));
  keeper_.poll(numbered(6), now_);
  drive_memory();
  EXPECT_TRUE(keeper_.stored() == numbered(6));
}

// wire.md D15.
TEST_F(SettingsKeeperTest, RetriesEverySecondUntilTheChangeIsStored) {
  keeper_.settings_changed();
  for (int failures = 0; failures < 3; ++failures) {
    memory_.unanswered_writes = 4;  // three attempts, and the write that would invalidate the copy
    keeper_.poll(numbered(5), now_);
    ASSERT_TRUE(keeper_.busy()) << failures;
    drive_memory();
    keeper_.poll(numbered(5), now_);
    ASSERT_FALSE(keeper_.busy());
    ASSERT_TRUE(keeper_.retry().armed());
    pass(milliseconds(999));
    keeper_.poll(numbered(5), now_);
    EXPECT_FALSE(keeper_.busy()) << "the retry starts too early";
    pass(milliseconds(1));
  }
  keeper_.poll(numbered(5), now_);
  drive_memory();
  keeper_.poll(numbered(5), now_);
  EXPECT_TRUE(keeper_.stored() == numbered(5));
  EXPECT_FALSE(keeper_.retry().armed());
}

// wire.md D15.
TEST_F(SettingsKeeperTest, ACommandThatCannotBeStoredDoesNotPostponeTheRetry) {
  // Three attempts, and the write that would invalidate the copy.
  constexpr std::size_t kWritesOfAFailure = 4;
  keeper_.settings_changed();
  memory_.unanswered_writes = 2 * kWritesOfAFailure;
  keeper_.poll(numbered(5), now_);
  drive_memory();
  keeper_.save(numbered(6), now_);  // the command has waited for the end of the first save
  pass(milliseconds(50));
  drive_memory();
  ASSERT_FALSE(keeper_.saved());
  keeper_.poll(numbered(5), now_);
  EXPECT_FALSE(keeper_.busy()) << "the retry starts too early";
  pass(milliseconds(950));
  keeper_.poll(numbered(5), now_);
  EXPECT_TRUE(keeper_.busy()) << "the retry has not started one second after the first failure";
}

// wire.md D15. A save of four pages that fails at the third attempt may write six pages and then invalidates
// the copy. Each page may take 10 ms, and its transfers on the bus take time too. Two such saves, one without
// a command and one for the command, could therefore take more than the 200 ms within which the reply to the
// command must begin.
TEST_F(SettingsKeeperTest, ASaveForWhichACommandWaitsEndsAtTheNextFailedAttempt) {
  keeper_.settings_changed();
  keeper_.poll(numbered(5), now_);
  keeper_.let_command_through();
  memory_.unanswered_writes = 2;  // one attempt, and the write that would invalidate the copy
  drive_memory();
  EXPECT_EQ(writes(), 2U);
  store(numbered(6));
  EXPECT_TRUE(keeper_.saved());
  EXPECT_TRUE(keeper_.stored() == numbered(6));
}

TEST_F(SettingsKeeperTest, TheSaveOfACommandIsNotShortened) {
  keeper_.save(numbered(5), now_);
  keeper_.let_command_through();
  memory_.unanswered_writes = 2;
  drive_memory();
  EXPECT_TRUE(keeper_.saved());
}

TEST_F(SettingsKeeperTest, ACopyThatMayHoldRefusedSettingsIsInvalidated) {
  store(numbered(5));
  memory_.unanswered_writes = 4;
  memory_.unanswered_but_done = true;
  store(numbered(6));
  EXPECT_FALSE(keeper_.saved());
  EXPECT_TRUE(keeper_.stored() == numbered(5));
  keeper_.poll(numbered(5), now_);
  ASSERT_TRUE(keeper_.busy());
  drive_memory();
  keeper_.poll(numbered(5), now_);
  EXPECT_FALSE(keeper_.busy());
  EXPECT_TRUE(Boot(memory_).stored() == numbered(5));
}

TEST_F(SettingsKeeperTest, IfTheSettingsChangeWhileARefusedCopyIsInvalidatedTheChangeIsStoredImmediately) {
  store(numbered(5));
  memory_.unanswered_writes = 4;
  store(numbered(6));
  ASSERT_FALSE(keeper_.saved());
  keeper_.poll(numbered(5), now_);
  drive_memory();              // invalidates the copy
  keeper_.settings_changed();  // the host watchdog has expired during the write
  keeper_.poll(numbered(7), now_);
  EXPECT_TRUE(keeper_.busy());
  drive_memory();
  EXPECT_TRUE(keeper_.stored() == numbered(7));
}

TEST_F(SettingsKeeperTest, StoredSettingsAreUncertainUntilARefusedCopyIsInvalidated) {
  store(numbered(5));
  EXPECT_TRUE(keeper_.certain());
  memory_.unanswered_writes = 4;
  store(numbered(6));
  EXPECT_FALSE(keeper_.certain());
  keeper_.poll(numbered(5), now_);
  drive_memory();
  EXPECT_TRUE(keeper_.certain());
}

// wire.md D15.
TEST_F(SettingsKeeperTest, AnInvalidationWithoutEffectIsRepeatedEverySecond) {
  store(numbered(5));
  memory_.noisy_reads = kAttempts;
  memory_.ignored_after = kAttempts;
  store(numbered(21));
  EXPECT_FALSE(keeper_.certain());
  for (unsigned second = 0; second < 3; ++second) {
    keeper_.poll(numbered(5), now_ + milliseconds(1000 * second));
    ASSERT_TRUE(keeper_.busy());
    drive_memory();
    EXPECT_FALSE(keeper_.certain());
    keeper_.poll(numbered(5), now_ + milliseconds(1000 * second));
    EXPECT_FALSE(keeper_.busy());
  }
  memory_.ignored_after = SIZE_MAX;
  keeper_.poll(numbered(5), now_ + milliseconds(3000));
  drive_memory();
  EXPECT_TRUE(keeper_.certain());
  EXPECT_TRUE(Boot(memory_).stored() == numbered(5));
}

// The other place holds the settings of an earlier save, which a reset does not load.
TEST_F(SettingsKeeperTest, AMemoryThatIgnoresAllWritesLeavesTheStoredSettingsCertain) {
  store(numbered(5));
  store(numbered(6));
  memory_.ignored_after = 0;
  store(numbered(7));
  EXPECT_FALSE(keeper_.saved());
  const std::size_t writes = memory_.writes.size();
  for (unsigned second = 0; second < 10; ++second) {
    keeper_.poll(numbered(6), now_ + milliseconds(1000 * second));
    EXPECT_FALSE(keeper_.busy());
  }
  EXPECT_TRUE(keeper_.certain());
  EXPECT_EQ(memory_.writes.size(), writes);
  EXPECT_TRUE(Boot(memory_).stored() == numbered(6));
}

TEST(SettingsKeeperAtReset, TheSettingsAreUncertainUntilASaveIfTheMemoryDidNotAnswer) {
  FakeMemory memory;
  memory.failing_reads = kReadsOfASilentMemory;
  SettingsKeeper keeper(the_model());
  while (keeper.busy()) {
    keeper.done(memory.run(keeper.job()).value_or(false));
  }
  EXPECT_TRUE(keeper.stored() == factory());
  EXPECT_FALSE(keeper.certain());
  keeper.save(factory(), Time(1000));
  while (keeper.busy()) {
    keeper.done(memory.run(keeper.job()).value_or(false));
  }
  EXPECT_TRUE(keeper.certain());
}

// The copy that could not be read may be the newer one, and a later reset may load it.
TEST(SettingsKeeperAtReset, IfOneCopyCouldNotBeReadTheSettingsAreUncertainUntilASave) {
  FakeMemory memory;
  put(memory, 0, numbered(5), 8);
  put(memory, 1, numbered(6), 7);
  memory.failing_reads = kAttempts;
  SettingsKeeper keeper(the_model());
  const auto drive_memory = [&] {
    while (keeper.busy()) {
      keeper.done(memory.run(keeper.job()).value_or(false));
    }
  };
  drive_memory();
  ASSERT_TRUE(keeper.stored() == numbered(6));
  EXPECT_FALSE(keeper.certain());
  keeper.save(numbered(6), Time(1000));
  drive_memory();
  EXPECT_TRUE(keeper.certain());
  EXPECT_TRUE(Boot(memory).stored() == numbered(6));
}

TEST_F(SettingsKeeperTest, ACommandIsStoredWithoutWaitingForTheNextRetry) {
  keeper_.settings_changed();
  memory_.unanswered_writes = 4;
  keeper_.poll(numbered(5), now_);
  drive_memory();
  store(numbered(6));  // before `poll` has processed the failed save
  EXPECT_TRUE(keeper_.saved());
  keeper_.poll(numbered(6), now_);
  EXPECT_FALSE(keeper_.busy());
  EXPECT_FALSE(keeper_.retry().armed());
}

}  // namespace
}  // namespace ex9000
