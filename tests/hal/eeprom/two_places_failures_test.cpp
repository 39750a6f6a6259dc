// Tests saves during which the EEPROM fails: wire.md section 8, "A valid reply means that the settings are
// stored." record_cuts_test.cpp also tests what each kind of failure leaves.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>

#include "tests/hal/eeprom/two_places_bench.hpp"

namespace ex9000 {
namespace {

TEST(TwoPlacesFailures, AWriteIsRepeatedAfterOneOrTwoFailedAttempts) {
  for (std::size_t FakeEeprom::*const failure :
       {&FakeEeprom::noisy_reads, &FakeEeprom::unanswered_writes, &FakeEeprom::failing_reads}) {
    for (std::size_t times = 1; times < kAttempts; ++times) {
      FakeEeprom memory;
      Boot run(memory);
      memory.*failure = times;
      EXPECT_TRUE(run.save(numbered(1)));
      EXPECT_EQ(memory.writes.size(), times + 1);
      EXPECT_TRUE(Boot(memory).stored() == numbered(1));
    }
  }
}

TEST(TwoPlacesFailures, AfterThreeFailedAttemptsTheNewRecordIsWithdrawn) {
  FakeEeprom memory;
  Boot run(memory);
  memory.noisy_reads = kAttempts;
  EXPECT_FALSE(run.save(numbered(1)));
  EXPECT_EQ(memory.writes.size(), kAttempts + 1);
  EXPECT_TRUE(run.stored() == factory());
  EXPECT_TRUE(Boot(memory).stored() == factory());
}

TEST(TwoPlacesFailures, AfterAFailedSaveUnreadableSettingsStayUnreadable) {
  FakeEeprom memory;
  put(memory, 0, numbered(5), 7);
  corrupt(memory, 0);
  Boot run(memory);
  memory.unanswered_writes = kAttempts + 1;
  EXPECT_FALSE(run.save(numbered(1)));
  EXPECT_TRUE(run.keeper().unreadable());
}

TEST(TwoPlacesFailures, AFailedSaveDoesNotWriteTheCopyThatHoldsTheOldSettings) {
  FakeEeprom memory;
  put(memory, 0, numbered(5), 7);
  Boot run(memory);
  memory.noisy_reads = kAttempts;
  EXPECT_FALSE(run.save(numbered(1)));
  for (const std::uint16_t address : memory.writes) {
    EXPECT_NE(address / kPage, kCopies[0] / kPage);
  }
}

// The end of a refused record stays in the memory after its beginning has been overwritten.
TEST(TwoPlacesFailures, NoPowerFailureInTheNextSaveCompletesARefusedRecord) {
  Settings refused = numbered(1);
  refused.name = Name("REFUSE");
  Settings next = numbered(1);
  next.name = Name("NEXT");
  for (std::size_t written = 0;; ++written) {
    FakeEeprom memory;
    put(memory, 0, numbered(1), 7);
    Boot run(memory);
    memory.noisy_reads = kAttempts;
    ASSERT_FALSE(run.save(refused));
    ASSERT_TRUE(run.keeper().certain());
    memory.power = written;
    if (run.save(next)) {
      EXPECT_GT(written, 20U);
      break;
    }
    memory.power.reset();
    EXPECT_FALSE(Boot(memory).stored() == refused) << written;
  }
}

/// Saves settings, of which `pages_before` pages succeed. The read-back of the next page, the last one,
/// differs each time, so the save fails although its record is complete. The write that withdraws the record
/// has no effect.
void refuse_a_complete_record(Boot& run, FakeEeprom& memory, std::size_t pages_before = 0) {
  memory.good_jobs = 2 * pages_before;
  memory.noisy_reads = kAttempts;
  memory.ignored_after = pages_before + kAttempts;
  EXPECT_FALSE(run.save(numbered(21)));
  ASSERT_TRUE(Boot(memory).stored() == numbered(21)) << "the record is valid, so this test can fail";
  EXPECT_FALSE(run.keeper().certain());
}

// A memory that answers a write without doing it must not make refused settings valid.
TEST(TwoPlacesFailures, AWithdrawalWithoutEffectIsNoticedAndRepeated) {
  FakeEeprom memory;
  put(memory, 0, numbered(1), 7);
  Boot run(memory);
  refuse_a_complete_record(run, memory);
  EXPECT_TRUE(run.pass(milliseconds(0), numbered(1)));
  EXPECT_FALSE(run.keeper().certain());

  memory.ignored_after = SIZE_MAX;
  EXPECT_TRUE(run.pass(milliseconds(1000), numbered(1)) || run.pass(milliseconds(1000), numbered(1)));
  EXPECT_TRUE(run.keeper().certain());
  EXPECT_TRUE(Boot(memory).stored() == numbered(1));
}

TEST(TwoPlacesFailures, AWithdrawalWithoutEffectOfALongOrOfTheFirstRecordIsNoticed) {
  FakeEeprom longer;
  put_longer(longer, 0, numbered(1), 7, 96);
  Boot run(longer);
  refuse_a_complete_record(run, longer, 3);
  FakeEeprom blank;
  Boot first(blank);
  refuse_a_complete_record(first, blank);
}

TEST(TwoPlacesFailures, AWithdrawalThatCannotBeReadBackIsRepeated) {
  FakeEeprom memory;
  Boot run(memory);
  memory.noisy_reads = kAttempts;
  EXPECT_FALSE(run.save(numbered(1)));
  EXPECT_TRUE(run.keeper().certain());
  memory.good_jobs = 1;
  memory.failing_reads = kAttempts + 1;  // also the read-back of the withdrawal
  EXPECT_FALSE(run.save(numbered(2)));
  EXPECT_FALSE(run.keeper().certain());
  EXPECT_TRUE(run.pass(milliseconds(0), factory()));
  EXPECT_TRUE(run.keeper().certain());
}

// A worn cell that keeps its value does not make the copy valid, so it is not written again and again.
TEST(TwoPlacesFailures, AWithdrawalThatIsIncompleteButSufficientIsNotRepeated) {
  FakeEeprom memory;
  Boot run(memory);
  ASSERT_TRUE(run.save(numbered(1)));
  memory.noisy_reads = kAttempts;
  memory.stuck = true;
  EXPECT_FALSE(run.save(numbered(21)));
  EXPECT_TRUE(run.keeper().certain());
  EXPECT_TRUE(Boot(memory).stored() == numbered(1));
}

// The memory did not answer at reset. Then a save failed, and its copy could not be withdrawn. The next
// save reads all copies again.
TEST(TwoPlacesFailures, RefusedSettingsAreNotUsedWhenAllCopiesAreReadAgain) {
  FakeEeprom memory;
  put(memory, 0, numbered(5), 7);
  memory.failing_reads = kReadsOfASilentEeprom;
  Boot run(memory);
  ASSERT_EQ(run.source(), SettingsSource::NoneGood);
  memory.unanswered_writes = kAttempts + 1;
  // The memory carries out these writes but does not answer them. First it stores the refused settings. Then
  // it stores the zeros that withdraw this copy.
  memory.unanswered_but_done = true;
  EXPECT_FALSE(run.save(numbered(6)));
  put(memory, 1, numbered(6), 8);  // as if the withdrawal had not been done
  memory.writes.clear();
  memory.unanswered_writes = kAttempts;
  memory.unanswered_but_done = false;
  EXPECT_FALSE(run.save(numbered(9)));
  for (const std::uint16_t address : memory.writes) {
    EXPECT_NE(address, kCopies[0]) << "a write to the only copy without refused settings";
  }
  EXPECT_TRUE(Boot(memory).stored() == numbered(5));
}

TEST(TwoPlacesFailures, RefusedSettingsAreNotUsedWhenAllCopiesWereBadAndAreReadAgain) {
  constexpr std::size_t kUntilTheReadBack = 2 * kAttempts + 1;  // the reads of both places, and the write
  FakeEeprom memory;
  put(memory, 0, numbered(5), 7);
  put(memory, 1, numbered(6), 8);
  corrupt(memory, 0);
  corrupt(memory, 1);
  Boot run(memory);
  memory.good_jobs = kUntilTheReadBack;
  memory.noisy_reads = kAttempts;
  memory.ignored_after = kAttempts;
  EXPECT_FALSE(run.save(numbered(21)));
  ASSERT_TRUE(Boot(memory).stored() == numbered(21)) << "the record is valid, so this test can fail";
  memory.good_jobs = kUntilTheReadBack;
  memory.noisy_reads = kAttempts;
  memory.ignored_after = SIZE_MAX;
  EXPECT_FALSE(run.save(numbered(9)));
  EXPECT_TRUE(Boot(memory).stored() == factory());
}

TEST(TwoPlacesFailures, AfterAnUnreadableResetASaveFailsWhileAPlaceDoesNotAnswer) {
  FakeEeprom memory;
  put(memory, 0, numbered(5), 7);
  memory.failing_reads = kReadsOfASilentEeprom;
  Boot run(memory);
  memory.failing_reads = kAttempts;
  EXPECT_FALSE(run.save(numbered(9)));
  EXPECT_TRUE(memory.writes.empty());
  EXPECT_TRUE(Boot(memory).stored() == numbered(5));
}

/// The newest record (place 1, sequence number 8) is not read at a reset, so the older one is in force.
void put_two_of_which_the_newest_is_unread(FakeEeprom& memory) {
  put(memory, 0, numbered(5), 7);
  put(memory, 1, numbered(6), 8);
  memory.good_jobs = 1;
  memory.failing_reads = kAttempts;
}

// The settings of both records are stored, so a failed save must destroy neither.
TEST(TwoPlacesFailures, ASaveFailsWithoutAWriteWhileTheNewestRecordDoesNotAnswer) {
  FakeEeprom memory;
  put_two_of_which_the_newest_is_unread(memory);
  Boot run(memory);
  ASSERT_TRUE(run.stored() == numbered(5));
  put_two_of_which_the_newest_is_unread(memory);
  EXPECT_FALSE(run.save(numbered(9)));
  run.pass(milliseconds(1000), numbered(5));
  EXPECT_TRUE(memory.writes.empty());
  EXPECT_TRUE(Boot(memory).stored() == numbered(6));
}

TEST(TwoPlacesFailures, ASaveThatFailsLeavesTheNewestRecordThatTheResetCouldNotRead) {
  FakeEeprom memory;
  put_two_of_which_the_newest_is_unread(memory);
  Boot run(memory);
  memory.unanswered_writes = kAttempts;  // but not the one that withdraws the record
  EXPECT_FALSE(run.save(numbered(9)));
  EXPECT_TRUE(Boot(memory).stored() == numbered(6));
  EXPECT_TRUE(run.save(numbered(9)));
  EXPECT_TRUE(Boot(memory).stored() == numbered(9));
}

}  // namespace
}  // namespace ex9000
