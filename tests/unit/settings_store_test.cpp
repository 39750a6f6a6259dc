// The settings in their memory: wire.md section 8. "A reply means that it is stored. Power may fail at any
// instant."
#include "firmware/settings/store.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <iterator>
#include <optional>
#include <set>
#include <string_view>
#include <vector>

namespace ex9000 {
namespace {

using Found = SettingsStore::Found;

constexpr std::size_t kPage = 32;
constexpr std::size_t kAttempts = 3;
constexpr std::size_t kStuckCell = 3;

const Model& model(std::string_view designation) { return *find_model(designation); }

const Model& the_model() { return model("EX9042D-M"); }

Settings factory() { return Settings::factory(the_model()); }

/// Settings that tell themselves apart.
Settings numbered(unsigned number) {
  Settings settings = factory();
  settings.address = static_cast<std::uint8_t>(1 + number % 247);
  settings.safe_value = static_cast<std::uint16_t>(number & 0x1FFFU);
  settings.watchdog_timeout = static_cast<std::uint8_t>(number * 7 + 1);
  return settings;
}

/// A few pages of memory that can fail in all the ways a memory can.
class FakeMemory {
 public:
  enum class Garbage { None, Zeroes, Ones, MixedWithOld, MixedWithNew };
  static constexpr Garbage kEveryGarbage[] = {Garbage::None, Garbage::Zeroes, Garbage::Ones,
                                              Garbage::MixedWithOld, Garbage::MixedWithNew};

  /// Does the job as far as there is power; nothing where it has failed meanwhile, else whether the memory
  /// answered.
  std::optional<bool> run(const MemoryJob& job) {
    const bool writing = job.kind == MemoryJob::Kind::Write;
    const std::size_t size = writing ? job.source.size : job.destination.size;
    EXPECT_NE(size, 0U);
    EXPECT_EQ(job.address / kPage, (job.address + size - 1) / kPage) << "a job crosses a page";
    if (job.address + size > cells.size()) {
      ADD_FAILURE() << "a job leaves the memory";
      return false;
    }
    return writing ? write(job) : read(job);
  }

  std::vector<std::uint8_t> cells = std::vector<std::uint8_t>(4 * kPage, 0xFF);
  std::size_t failing_reads = 0;      ///< so many next reads are not answered
  std::size_t noisy_reads = 0;        ///< so many next reads read nonsense
  std::size_t unanswered_writes = 0;  ///< so many next writes are not answered, and not done
  bool unanswered_but_done = false;   ///< or done all the same
  bool stuck = false;                 ///< the address of the settings cannot be written, in any page
  std::optional<std::size_t> power;   ///< fails when so many more bytes are written
  Garbage garbage = Garbage::None;    ///< in the byte that was being written then
  std::vector<std::uint16_t> reads;   ///< addresses
  std::vector<std::uint16_t> writes;  ///< likewise
  std::size_t bytes_written = 0;

 private:
  std::optional<bool> read(const MemoryJob& job) {
    reads.push_back(job.address);
    if (failing_reads > 0) {
      --failing_reads;
      return false;
    }
    std::copy_n(cells.begin() + job.address, job.destination.size, job.destination.data);
    if (noisy_reads > 0) {
      --noisy_reads;
      job.destination.data[job.destination.size / 2] ^= 0x10U;
    }
    return true;
  }

  std::optional<bool> write(const MemoryJob& job) {
    writes.push_back(job.address);
    const bool answers = unanswered_writes == 0;
    if (!answers) {
      --unanswered_writes;
      if (!unanswered_but_done) {
        return false;
      }
    }
    for (std::size_t i = 0; i < job.source.size; ++i) {
      std::uint8_t& cell = cells[job.address + i];
      if (power && *power == 0) {
        cell = spoiled(cell, job.source[i]);
        return std::nullopt;
      }
      if (power) {
        --*power;
      }
      if (!stuck || (job.address + i) % kPage != kStuckCell) {
        cell = job.source[i];
      }
      ++bytes_written;
    }
    if (power && *power == 0) {
      return std::nullopt;  // all is written, but nobody lives to hear of it
    }
    return answers;
  }

  [[nodiscard]] std::uint8_t spoiled(std::uint8_t old_byte, std::uint8_t new_byte) const {
    switch (garbage) {
      case Garbage::Zeroes:
        return 0x00;
      case Garbage::Ones:
        return 0xFF;
      case Garbage::MixedWithOld:
        return static_cast<std::uint8_t>(old_byte ^ 0xA5U);
      case Garbage::MixedWithNew:
        return static_cast<std::uint8_t>(new_byte ^ 0x5AU);
      case Garbage::None:
        break;
    }
    return old_byte;
  }
};

/// False where the power failed.
bool drive(SettingsStore& store, FakeMemory& memory) {
  for (int jobs = 0; store.busy(); ++jobs) {
    if (jobs == 100) {
      ADD_FAILURE() << "the store never finishes";
      return false;
    }
    const std::optional<bool> ok = memory.run(store.job());
    if (!ok) {
      return false;
    }
    store.done(*ok);
  }
  return true;
}

/// A module's store from one reset to the next.
class Boot {
 public:
  explicit Boot(FakeMemory& memory, const Model& which = the_model()) : memory_(memory), store_(which) {
    store_.begin_loading();
    drive(store_, memory_);
  }
  /// Whether the save was reported as done.
  bool save(const Settings& settings) {
    store_.begin_saving(settings);
    return drive(store_, memory_) && store_.saved();
  }
  [[nodiscard]] const Settings& stored() const { return store_.stored(); }
  [[nodiscard]] Found found() const { return store_.found(); }

 private:
  FakeMemory& memory_;
  SettingsStore store_;
};

/// Where the two copies lie.
std::vector<std::uint16_t> copies() {
  FakeMemory memory;
  const Boot run(memory);
  const std::set<std::uint16_t> addresses(memory.reads.begin(), memory.reads.end());
  return {addresses.begin(), addresses.end()};
}

void put(FakeMemory& memory, std::size_t copy, const Settings& settings, std::uint16_t sequence,
         const Model& which = the_model()) {
  const Record record = encode_record(which, {settings, sequence});
  std::copy(record.begin(), record.end(), memory.cells.begin() + copies().at(copy));
}

void corrupt(FakeMemory& memory, std::size_t copy) { memory.cells[copies().at(copy) + 5U] ^= 0x01U; }

// --- loading ---

TEST(SettingsStore, KeepsTwoCopiesInPagesOfTheirOwn) {
  ASSERT_EQ(copies().size(), 2U);
  EXPECT_NE(copies()[0] / kPage, copies()[1] / kPage);
}

TEST(SettingsStore, DoesNothingBeforeItIsTold) {
  SettingsStore store(the_model());
  EXPECT_FALSE(store.busy());
  EXPECT_FALSE(store.loading());
  EXPECT_EQ(store.job().kind, MemoryJob::Kind::None);
}

TEST(SettingsStore, LoadsUntilBothCopiesAreRead) {
  FakeMemory memory;
  SettingsStore store(the_model());
  store.begin_loading();
  EXPECT_TRUE(store.loading());
  EXPECT_TRUE(store.busy());
  EXPECT_EQ(store.job().kind, MemoryJob::Kind::Read);
  drive(store, memory);
  EXPECT_FALSE(store.loading());
  EXPECT_FALSE(store.busy());
  EXPECT_EQ(store.job().kind, MemoryJob::Kind::None);
}

TEST(SettingsStore, WantsTheSameJobUntilItIsDone) {
  SettingsStore store(the_model());
  store.begin_loading();
  const MemoryJob first = store.job();
  const MemoryJob second = store.job();
  EXPECT_EQ(first.kind, second.kind);
  EXPECT_EQ(first.address, second.address);
  EXPECT_EQ(first.destination.data, second.destination.data);
  EXPECT_EQ(first.destination.size, second.destination.size);
}

TEST(SettingsStore, FindsFactorySettingsOfEveryModelInABlankMemory) {
  for (const Model& each : kModels) {
    FakeMemory memory;
    const Boot run(memory, each);
    EXPECT_EQ(run.found(), Found::Blank) << each.designation;
    EXPECT_TRUE(run.stored() == Settings::factory(each)) << each.designation;
    EXPECT_TRUE(memory.writes.empty());
  }
}

TEST(SettingsStore, FindsTheOnlyGoodCopyBesideABlankOne) {
  for (const std::size_t copy : {0U, 1U}) {
    FakeMemory memory;
    put(memory, copy, numbered(5), 7);
    const Boot run(memory);
    EXPECT_EQ(run.found(), Found::Settings);
    EXPECT_TRUE(run.stored() == numbered(5));
  }
}

TEST(SettingsStore, FindsTheOnlyGoodCopyBesideACorruptedOne) {
  for (const std::size_t copy : {0U, 1U}) {
    FakeMemory memory;
    put(memory, copy, numbered(5), 7);
    put(memory, 1 - copy, numbered(6), 8);
    corrupt(memory, 1 - copy);
    const Boot run(memory);
    EXPECT_EQ(run.found(), Found::Settings);
    EXPECT_TRUE(run.stored() == numbered(5));
    EXPECT_TRUE(memory.writes.empty());
  }
}

TEST(SettingsStore, FindsTheLaterOfTwoGoodCopies) {
  for (const std::size_t later : {0U, 1U}) {
    FakeMemory memory;
    put(memory, later, numbered(5), 8);
    put(memory, 1 - later, numbered(6), 7);
    EXPECT_TRUE(Boot(memory).stored() == numbered(5));
  }
}

TEST(SettingsStore, Sequence0IsLaterThanFFFF) {
  for (const std::size_t later : {0U, 1U}) {
    FakeMemory memory;
    put(memory, later, numbered(5), 0x0000);
    put(memory, 1 - later, numbered(6), 0xFFFF);
    EXPECT_TRUE(Boot(memory).stored() == numbered(5));
  }
}

TEST(SettingsStore, TwoCorruptedCopiesAreUnreadableAndStayAsTheyAre) {
  FakeMemory memory;
  put(memory, 0, numbered(5), 7);
  put(memory, 1, numbered(6), 8);
  corrupt(memory, 0);
  corrupt(memory, 1);
  const Boot run(memory);
  EXPECT_EQ(run.found(), Found::Unreadable);
  EXPECT_TRUE(run.stored() == factory());
  EXPECT_TRUE(memory.writes.empty());
}

TEST(SettingsStore, ACorruptedCopyBesideABlankOneIsUnreadable) {
  for (const std::size_t copy : {0U, 1U}) {
    FakeMemory memory;
    put(memory, copy, numbered(5), 7);
    corrupt(memory, copy);
    const Boot run(memory);
    EXPECT_EQ(run.found(), Found::Unreadable);
    EXPECT_TRUE(run.stored() == factory());
  }
}

TEST(SettingsStore, SettingsOfAnotherModelAreUnreadable) {
  FakeMemory memory;
  put(memory, 0, Settings::factory(model("EX9043D-M")), 7, model("EX9043D-M"));
  put(memory, 1, Settings::factory(model("EX9043D-M")), 8, model("EX9043D-M"));
  const Boot run(memory);
  EXPECT_EQ(run.found(), Found::Unreadable);
  EXPECT_TRUE(run.stored() == factory());
}

TEST(SettingsStore, AReadThatFailsIsTriedUpToThreeTimes) {
  for (std::size_t failing = 1; failing < kAttempts; ++failing) {
    FakeMemory memory;
    put(memory, 0, numbered(5), 8);
    put(memory, 1, numbered(6), 7);
    memory.failing_reads = failing;
    const Boot run(memory);
    EXPECT_EQ(run.found(), Found::Settings);
    EXPECT_TRUE(run.stored() == numbered(5)) << failing;
    EXPECT_EQ(memory.reads.size(), failing + 2);
  }
}

TEST(SettingsStore, AReadOfNonsenseIsTriedUpToThreeTimes) {
  for (std::size_t noisy = 1; noisy < kAttempts; ++noisy) {
    FakeMemory memory;
    put(memory, 0, numbered(5), 8);
    put(memory, 1, numbered(6), 7);
    memory.noisy_reads = noisy;
    EXPECT_TRUE(Boot(memory).stored() == numbered(5)) << noisy;
  }
}

TEST(SettingsStore, ACopyThatCannotBeReadLeavesTheOtherOne) {
  FakeMemory memory;
  put(memory, 0, numbered(5), 8);
  put(memory, 1, numbered(6), 7);
  memory.failing_reads = kAttempts;
  const Boot run(memory);
  EXPECT_EQ(run.found(), Found::Settings);
  EXPECT_TRUE(run.stored() == numbered(6));
}

TEST(SettingsStore, EachCopyHasThreeReadsOfItsOwn) {
  FakeMemory memory;
  put(memory, 0, numbered(5), 8);
  corrupt(memory, 0);
  put(memory, 1, numbered(6), 7);
  SettingsStore store(the_model());
  store.begin_loading();
  for (std::size_t i = 0; i < kAttempts; ++i) {
    store.done(*memory.run(store.job()));
  }
  memory.failing_reads = kAttempts - 1;
  drive(store, memory);
  EXPECT_TRUE(store.stored() == numbered(6));
}

TEST(SettingsStore, AMemoryThatDoesNotAnswerIsUnreadable) {
  FakeMemory memory;
  memory.failing_reads = 2 * kAttempts;
  const Boot run(memory);
  EXPECT_EQ(run.found(), Found::Unreadable);
  EXPECT_TRUE(run.stored() == factory());
  EXPECT_EQ(memory.reads.size(), 2 * kAttempts);
}

// --- saving ---

TEST(SettingsStore, WhatIsSavedIsStoredAndFoundAtTheNextLoad) {
  FakeMemory memory;
  Boot run(memory);
  EXPECT_TRUE(run.save(numbered(1)));
  EXPECT_TRUE(run.stored() == numbered(1));
  EXPECT_EQ(run.found(), Found::Settings);
  const Boot next(memory);
  EXPECT_EQ(next.found(), Found::Settings);
  EXPECT_TRUE(next.stored() == numbered(1));
}

TEST(SettingsStore, ASaveWritesOneCopyOnceAndReadsItBack) {
  FakeMemory memory;
  Boot run(memory);
  memory.reads.clear();
  EXPECT_TRUE(run.save(numbered(1)));
  EXPECT_EQ(memory.writes.size(), 1U);
  EXPECT_EQ(memory.reads, memory.writes);
}

TEST(SettingsStore, SavesAlternateBetweenTheCopies) {
  FakeMemory memory;
  Boot run(memory);
  for (unsigned i = 1; i <= 6; ++i) {
    EXPECT_TRUE(run.save(numbered(i)));
  }
  for (std::size_t i = 1; i < memory.writes.size(); ++i) {
    EXPECT_NE(memory.writes[i], memory.writes[i - 1]);
  }
}

TEST(SettingsStore, SavesAlternateAcrossResetsToo) {
  FakeMemory memory;
  for (unsigned i = 1; i <= 6; ++i) {
    EXPECT_TRUE(Boot(memory).save(numbered(i)));
    EXPECT_TRUE(Boot(memory).stored() == numbered(i));
  }
  for (std::size_t i = 1; i < memory.writes.size(); ++i) {
    EXPECT_NE(memory.writes[i], memory.writes[i - 1]);
  }
}

TEST(SettingsStore, ASaveLeavesTheCopyThatHoldsTheOldSettings) {
  for (const std::size_t current : {0U, 1U}) {
    FakeMemory memory;
    put(memory, current, numbered(5), 8);
    put(memory, 1 - current, numbered(6), 7);
    EXPECT_TRUE(Boot(memory).save(numbered(9)));
    EXPECT_EQ(memory.writes, std::vector<std::uint16_t>{copies()[1 - current]});
  }
}

TEST(SettingsStore, ASaveOverwritesACorruptedCopyAndNotTheGoodOne) {
  for (const std::size_t good : {0U, 1U}) {
    FakeMemory memory;
    put(memory, good, numbered(5), 8);
    put(memory, 1 - good, numbered(6), 9);
    corrupt(memory, 1 - good);
    EXPECT_TRUE(Boot(memory).save(numbered(9)));
    EXPECT_EQ(memory.writes, std::vector<std::uint16_t>{copies()[1 - good]});
    EXPECT_TRUE(Boot(memory).stored() == numbered(9));
  }
}

TEST(SettingsStore, ASaveEndsUnreadable) {
  FakeMemory memory;
  put(memory, 0, numbered(5), 700);
  put(memory, 1, numbered(6), 701);
  corrupt(memory, 0);
  corrupt(memory, 1);
  Boot run(memory);
  EXPECT_TRUE(run.save(numbered(9)));
  EXPECT_EQ(run.found(), Found::Settings);
  EXPECT_TRUE(Boot(memory).stored() == numbered(9));
}

TEST(SettingsStore, SequenceNumbersWrapWithoutLosingASave) {
  FakeMemory memory;
  put(memory, 0, numbered(1000), 0xFFF8);
  for (unsigned i = 0; i < 20; ++i) {
    EXPECT_TRUE(Boot(memory).save(numbered(i)));
    EXPECT_TRUE(Boot(memory).stored() == numbered(i)) << i;
  }
}

TEST(SettingsStore, ManySavesFromOneResetWrapTheSequenceToo) {
  FakeMemory memory;
  put(memory, 1, numbered(1000), 0xFFFE);
  Boot run(memory);
  for (unsigned i = 0; i < 5; ++i) {
    EXPECT_TRUE(run.save(numbered(i)));
    EXPECT_TRUE(Boot(memory).stored() == numbered(i)) << i;
  }
}

// A reply means that it is stored, also where the memory was silent at reset only.
TEST(SettingsStore, WhatIsSavedAfterTheMemoryDidNotAnswerAtResetIsFoundAtTheNextLoad) {
  FakeMemory memory;
  put(memory, 0, numbered(5), 700);
  put(memory, 1, numbered(6), 701);
  memory.failing_reads = 2 * kAttempts;
  Boot run(memory);
  ASSERT_EQ(run.found(), Found::Unreadable);
  EXPECT_TRUE(run.save(numbered(9)));
  EXPECT_TRUE(Boot(memory).stored() == numbered(9));
}

// --- a save that fails ---

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

/// All ways for a save to fail three times.
const std::vector<void (*)(FakeMemory&)> kFailures{
    [](FakeMemory& memory) { memory.noisy_reads = kAttempts; },
    [](FakeMemory& memory) { memory.failing_reads = kAttempts; },
    [](FakeMemory& memory) { memory.unanswered_writes = kAttempts; },
    [](FakeMemory& memory) {
      memory.unanswered_writes = kAttempts;
      memory.unanswered_but_done = true;
    },
    [](FakeMemory& memory) { memory.stuck = true; },
};

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

// --- power cuts ---

class PowerCuts : public testing::Test {
 protected:
  static std::vector<FakeMemory> beginnings() {
    FakeMemory blank;
    FakeMemory one_copy;
    EXPECT_TRUE(Boot(one_copy).save(numbered(100)));
    FakeMemory two_copies = one_copy;
    EXPECT_TRUE(Boot(two_copies).save(numbered(101)));
    FakeMemory two_copies_the_other_way = two_copies;
    EXPECT_TRUE(Boot(two_copies_the_other_way).save(numbered(102)));
    return {blank, one_copy, two_copies, two_copies_the_other_way};
  }

  /// How many bytes a save writes when nothing cuts it short.
  static std::size_t bytes_of_a_save(FakeMemory memory, const Settings& to) {
    Boot run(memory);
    memory.bytes_written = 0;
    run.save(to);
    return memory.bytes_written;
  }

  /// Saves `to` with a cut behind `bytes`; checks what the next load finds, and returns it.
  Settings cut_and_load(FakeMemory& memory, const Settings& to, std::size_t bytes,
                        FakeMemory::Garbage garbage) {
    Boot run(memory);
    const Settings before = run.stored();
    memory.power = bytes;
    memory.garbage = garbage;
    EXPECT_FALSE(run.save(to)) << "no cut behind byte " << bytes;
    ++cuts_;
    with_power(memory);
    const Boot next(memory);
    EXPECT_TRUE(next.stored() == before || next.stored() == to) << "cut behind byte " << bytes;
    return next.stored();
  }

  static void with_power(FakeMemory& memory) {
    memory.power.reset();
    memory.failing_reads = memory.noisy_reads = memory.unanswered_writes = 0;
  }

  static void expect_works(FakeMemory& memory) {
    ASSERT_TRUE(Boot(memory).save(numbered(4000)));
    ASSERT_TRUE(Boot(memory).stored() == numbered(4000));
  }

  void TearDown() override { std::printf("power cuts: %zu\n", cuts_); }

  std::size_t cuts_ = 0;
};

TEST_F(PowerCuts, AtAnyByteOfASaveLeaveTheOldSettingsOrTheNew) {
  for (const FakeMemory& beginning : beginnings()) {
    const std::size_t bytes = bytes_of_a_save(beginning, numbered(200));
    for (std::size_t cut = 0; cut <= bytes; ++cut) {
      for (const FakeMemory::Garbage garbage : FakeMemory::kEveryGarbage) {
        FakeMemory memory = beginning;
        cut_and_load(memory, numbered(200), cut, garbage);
        expect_works(memory);
      }
    }
  }
}

TEST_F(PowerCuts, BehindTheLastByteLeaveTheNewSettings) {
  for (const FakeMemory& beginning : beginnings()) {
    FakeMemory memory = beginning;
    const std::size_t bytes = bytes_of_a_save(beginning, numbered(200));
    EXPECT_TRUE(cut_and_load(memory, numbered(200), bytes, FakeMemory::Garbage::None) == numbered(200));
  }
}

TEST_F(PowerCuts, AfterASaveWasReportedLeaveTheNewSettings) {
  for (const FakeMemory& beginning : beginnings()) {
    FakeMemory memory = beginning;
    ASSERT_TRUE(Boot(memory).save(numbered(200)));
    ++cuts_;
    EXPECT_TRUE(Boot(memory).stored() == numbered(200));
  }
}

TEST_F(PowerCuts, AtAnyByteOfASaveThatFailsLeaveTheOldSettingsOrTheNew) {
  for (const FakeMemory& beginning : beginnings()) {
    for (const auto fail : kFailures) {
      const auto failing = [&] {
        FakeMemory memory = beginning;
        fail(memory);
        return memory;
      };
      // Only the save fails; what was loaded was loaded before.
      const auto cut_at = [&](std::optional<std::size_t> cut) {
        FakeMemory memory = beginning;
        Boot run(memory);
        const Settings before = run.stored();
        memory = failing();
        memory.bytes_written = 0;
        memory.power = cut;
        memory.garbage = FakeMemory::Garbage::MixedWithOld;
        const bool saved = run.save(numbered(200));
        const std::size_t bytes = memory.bytes_written;
        with_power(memory);
        const Settings found = Boot(memory).stored();
        EXPECT_TRUE(found == numbered(200) || (!saved && found == before))
            << "cut behind byte " << cut.value_or(0);
        memory.stuck = false;
        expect_works(memory);
        return bytes;
      };
      const std::size_t bytes = cut_at(std::nullopt);
      for (std::size_t cut = 0; cut <= bytes; ++cut) {
        cut_at(cut);
        ++cuts_;
      }
    }
  }
}

TEST_F(PowerCuts, TwiceInARowLeaveTheOldSettingsOrTheNew) {
  for (const FakeMemory& beginning : beginnings()) {
    const std::size_t bytes = bytes_of_a_save(beginning, numbered(200));
    for (std::size_t first = 0; first <= bytes; ++first) {
      for (const FakeMemory::Garbage garbage : FakeMemory::kEveryGarbage) {
        FakeMemory once = beginning;
        const Settings between = cut_and_load(once, numbered(200), first, garbage);
        for (std::size_t second = 0; second <= bytes; ++second) {
          FakeMemory twice = once;
          const Settings found = cut_and_load(twice, numbered(300), second, garbage);
          EXPECT_TRUE(found == between || found == numbered(300));
          expect_works(twice);
        }
      }
    }
  }
}

TEST_F(PowerCuts, ManyTimesInARowLeaveTheOldSettingsOrTheNew) {
  for (FakeMemory memory : beginnings()) {
    for (unsigned i = 0; i < 1000; ++i) {
      const std::size_t cut = (i * 7) % (kRecordSize + 1);
      const auto garbage = FakeMemory::kEveryGarbage[i % std::size(FakeMemory::kEveryGarbage)];
      cut_and_load(memory, numbered(200 + i), cut, garbage);
    }
    expect_works(memory);
  }
}

}  // namespace
}  // namespace ex9000
