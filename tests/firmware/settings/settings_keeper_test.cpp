// Tests that SettingsKeeper stores changed settings, withdraws refused settings and retries after a failure:
// wire.md section 8, D6 and D15.
#include "firmware/settings/settings_keeper.hpp"

#include <gtest/gtest.h>

#include "tests/hal/eeprom/two_places_bench.hpp"

namespace ex9000 {
namespace {

constexpr Duration kNow = milliseconds(0);
constexpr Duration kSecond = milliseconds(1000);

class SettingsKeeperTest : public testing::Test {
 protected:
  SettingsKeeper& keeper() { return run_.keeper(); }
  [[nodiscard]] std::size_t writes() const { return eeprom_.writes.size(); }
  /// Makes the settings of a command complete in the EEPROM, although the save fails: the read-back differs
  /// each time, and later writes have no effect.
  void refuse(const Settings& settings) {
    eeprom_.noisy_reads = kAttempts;
    eeprom_.ignored_after = kAttempts;
    EXPECT_FALSE(run_.save(settings));
    ASSERT_TRUE(Boot(eeprom_).stored() == settings);
  }

  FakeEeprom eeprom_;
  Boot run_{eeprom_};
};

TEST(SettingsKeeperAtReset, IsLoadingAndBusyAtFirst) {
  const SettingsKeeper keeper(the_model());
  EXPECT_TRUE(keeper.loading());
  EXPECT_TRUE(keeper.busy());
}

TEST(SettingsKeeperAtReset, RequestsTheSameJobUntilItIsDone) {
  SettingsKeeper keeper(the_model());
  const MemoryJob first = keeper.job();
  const MemoryJob second = keeper.job();
  EXPECT_EQ(first.kind, MemoryJob::Kind::Load);
  EXPECT_EQ(second.kind, first.kind);
  EXPECT_EQ(second.record.data, first.record.data);
  EXPECT_EQ(second.record.size, kRecordRoom);
}

TEST_F(SettingsKeeperTest, ABlankMemoryMeansFactorySettingsAndIsNotUnreadable) {
  EXPECT_FALSE(keeper().loading());
  EXPECT_FALSE(keeper().unreadable());
  EXPECT_TRUE(run_.stored() == factory());
}

TEST_F(SettingsKeeperTest, WritesNothingWhileTheSettingsEqualTheStoredSettings) {
  EXPECT_FALSE(run_.pass(kNow, run_.stored()));
  keeper().settings_changed();  // the settings have changed and changed back
  EXPECT_FALSE(run_.pass(kNow, run_.stored()));
  EXPECT_EQ(writes(), 0U);
}

TEST_F(SettingsKeeperTest, StoresTheSettingsOfACommand) {
  EXPECT_TRUE(run_.save(numbered(5)));
  EXPECT_TRUE(run_.stored() == numbered(5));
  EXPECT_FALSE(run_.pass(kNow, numbered(5)));
  EXPECT_EQ(writes(), 1U);
}

TEST_F(SettingsKeeperTest, StoresAChangeWithoutACommand) {
  keeper().settings_changed();
  EXPECT_TRUE(run_.pass(kNow, numbered(5)));
  EXPECT_FALSE(run_.pass(kNow, numbered(5)));
  EXPECT_TRUE(run_.stored() == numbered(5));
  EXPECT_FALSE(keeper().retry().armed());
}

// wire.md D6: the host watchdog expires while a command is stored.
TEST_F(SettingsKeeperTest, StoresAChangeThatOccursWhileACommandIsStored) {
  run_.save(numbered(5));
  EXPECT_TRUE(run_.pass(kNow, numbered(6)));
  EXPECT_TRUE(run_.stored() == numbered(6));
}

// wire.md D15. One attempt, because a command may wait for its end, and one write that withdraws the record.
TEST_F(SettingsKeeperTest, RetriesEverySecondUntilTheChangeIsStored) {
  constexpr unsigned kFailures = 3;
  keeper().settings_changed();
  eeprom_.unanswered_writes = std::size_t{2} * kFailures;
  for (unsigned failures = 0; failures < kFailures; ++failures) {
    ASSERT_TRUE(run_.pass(milliseconds(1), numbered(5))) << failures;
    EXPECT_FALSE(run_.pass(kNow, numbered(5)));
    EXPECT_EQ(writes(), 2 * (failures + 1));
    EXPECT_FALSE(run_.pass(milliseconds(999), numbered(5))) << "the retry starts too early";
  }
  EXPECT_TRUE(run_.pass(milliseconds(1), numbered(5)));
  EXPECT_TRUE(run_.stored() == numbered(5));
  EXPECT_FALSE(run_.pass(kSecond, numbered(5)));
  EXPECT_FALSE(keeper().retry().armed());
}

// wire.md D15.
TEST_F(SettingsKeeperTest, ACommandThatCannotBeStoredDoesNotPostponeTheRetry) {
  keeper().settings_changed();
  eeprom_.unanswered_writes = 2 + kAttempts + 1;
  EXPECT_TRUE(run_.pass(kNow, numbered(5)));
  EXPECT_FALSE(run_.save(numbered(6)));  // the command has waited for the end of the first save
  EXPECT_FALSE(run_.pass(milliseconds(950), numbered(5))) << "the retry starts too early";
  EXPECT_TRUE(run_.pass(milliseconds(50), numbered(5))) << "the retry is late";
  EXPECT_TRUE(run_.stored() == numbered(5));
}

TEST_F(SettingsKeeperTest, RefusedSettingsAreWithdrawnAndTheStoredSettingsAreUncertainUntilThen) {
  run_.save(numbered(5));
  EXPECT_TRUE(keeper().certain());
  refuse(numbered(6));
  EXPECT_FALSE(keeper().certain());
  EXPECT_TRUE(run_.stored() == numbered(5));
  eeprom_.ignored_after = SIZE_MAX;
  EXPECT_TRUE(run_.pass(kNow, numbered(5)));
  EXPECT_TRUE(keeper().certain());
  EXPECT_FALSE(run_.pass(kSecond, numbered(5)));
  EXPECT_TRUE(Boot(eeprom_).stored() == numbered(5));
}

TEST_F(SettingsKeeperTest, IfTheSettingsChangeWhileRefusedSettingsAreWithdrawnTheChangeIsStoredImmediately) {
  run_.save(numbered(5));
  refuse(numbered(6));
  eeprom_.ignored_after = SIZE_MAX;
  EXPECT_TRUE(run_.pass(kNow, numbered(5)));
  keeper().settings_changed();  // the host watchdog has expired during the write
  EXPECT_TRUE(run_.pass(kNow, numbered(7)));
  EXPECT_TRUE(run_.stored() == numbered(7));
}

// wire.md D15.
TEST_F(SettingsKeeperTest, AWithdrawalWithoutEffectIsRepeatedEverySecond) {
  run_.save(numbered(5));
  refuse(numbered(21));
  for (unsigned second = 0; second < 3; ++second) {
    ASSERT_TRUE(run_.pass(second == 0 ? kNow : milliseconds(1), numbered(5)));
    EXPECT_FALSE(run_.pass(kNow, numbered(5)));
    EXPECT_FALSE(run_.pass(milliseconds(999), numbered(5)));
    EXPECT_FALSE(keeper().certain());
  }
  eeprom_.ignored_after = SIZE_MAX;
  EXPECT_TRUE(run_.pass(milliseconds(1), numbered(5)));
  EXPECT_TRUE(keeper().certain());
  EXPECT_TRUE(Boot(eeprom_).stored() == numbered(5));
}

// The other place holds the settings of an earlier save, which a reset does not load.
TEST_F(SettingsKeeperTest, AMemoryThatIgnoresAllWritesLeavesTheStoredSettingsCertain) {
  run_.save(numbered(5));
  run_.save(numbered(6));
  eeprom_.ignored_after = 0;
  EXPECT_FALSE(run_.save(numbered(7)));
  const std::size_t before = writes();
  for (unsigned second = 0; second < 10; ++second) {
    EXPECT_FALSE(run_.pass(kSecond, numbered(6)));
  }
  EXPECT_TRUE(keeper().certain());
  EXPECT_EQ(writes(), before);
  EXPECT_TRUE(Boot(eeprom_).stored() == numbered(6));
}

TEST_F(SettingsKeeperTest, ACommandIsStoredWithoutWaitingForTheNextRetry) {
  keeper().settings_changed();
  eeprom_.unanswered_writes = 2;
  EXPECT_TRUE(run_.pass(kNow, numbered(5)));
  EXPECT_TRUE(run_.save(numbered(6)));  // before `poll` has processed the failed save
  EXPECT_FALSE(run_.pass(kNow, numbered(6)));
  EXPECT_FALSE(keeper().retry().armed());
}

TEST(SettingsKeeperAtReset, TheSettingsAreUncertainUntilASaveIfTheMemoryDidNotAnswer) {
  FakeEeprom eeprom;
  eeprom.failing_reads = kReadsOfASilentEeprom;
  Boot run(eeprom);
  EXPECT_TRUE(run.stored() == factory());
  EXPECT_FALSE(run.keeper().certain());
  EXPECT_TRUE(run.save(factory()));
  EXPECT_TRUE(run.keeper().certain());
}

// The copy that could not be read may be the newer one, and a later reset may load it.
TEST(SettingsKeeperAtReset, IfOneCopyCouldNotBeReadTheSettingsAreUncertainUntilASave) {
  FakeEeprom eeprom;
  put(eeprom, 0, numbered(5), 8);
  put(eeprom, 1, numbered(6), 7);
  eeprom.failing_reads = kAttempts;
  Boot run(eeprom);
  ASSERT_TRUE(run.stored() == numbered(6));
  EXPECT_FALSE(run.keeper().certain());
  EXPECT_TRUE(run.save(numbered(6)));
  EXPECT_TRUE(run.keeper().certain());
  EXPECT_TRUE(Boot(eeprom).stored() == numbered(6));
}

// The memory answers again, and holds the user's settings. The module runs with the factory settings.
TEST(SettingsKeeperAtReset, ACommandThatFailsDoesNotReplaceSettingsThatCouldNotBeReadAtReset) {
  FakeEeprom eeprom;
  put(eeprom, 0, numbered(5), 7);
  eeprom.failing_reads = kReadsOfASilentEeprom;
  Boot run(eeprom);
  eeprom.good_jobs = 3;  // the keeper loads both copies again and writes a new one
  eeprom.noisy_reads = kAttempts;
  EXPECT_FALSE(run.save(numbered(9)));
  for (unsigned second = 0; second < 10; ++second) {
    EXPECT_FALSE(run.pass(kSecond, factory()));
  }
  EXPECT_TRUE(run.keeper().unreadable());
  EXPECT_FALSE(run.keeper().certain());
  EXPECT_TRUE(Boot(eeprom).stored() == numbered(5));
  EXPECT_TRUE(run.save(numbered(9)));
  EXPECT_TRUE(Boot(eeprom).stored() == numbered(9));
}

// --- firmware/extensions.md: registers 0x0305 and 0x0306 ---

TEST_F(SettingsKeeperTest, TheSourceStaysTheSameAfterASave) {
  run_.save(numbered(5));
  EXPECT_EQ(run_.source(), SettingsSource::Blank);
  EXPECT_EQ(Boot(eeprom_).source(), SettingsSource::Good);
}

TEST_F(SettingsKeeperTest, CountsOnlySavesThatSucceed) {
  EXPECT_EQ(keeper().saves(), 0U);
  run_.save(numbered(5));
  EXPECT_EQ(keeper().saves(), 1U);
  eeprom_.stuck = true;
  EXPECT_FALSE(run_.save(numbered(6)));
  EXPECT_EQ(keeper().saves(), 1U);
}

TEST_F(SettingsKeeperTest, StopsCountingAt65535) {
  for (unsigned i = 0; i < 65'540; ++i) {
    run_.save(numbered(i));
    eeprom_.reads.clear();
    eeprom_.writes.clear();
  }
  EXPECT_EQ(keeper().saves(), 65'535U);
}

}  // namespace
}  // namespace ex9000
