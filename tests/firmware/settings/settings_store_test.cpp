// Tests how the settings are loaded and saved: wire.md section 8, "A valid reply means that the settings are
// stored."
#include "firmware/settings/store.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/firmware/settings/settings_store_bench.hpp"

namespace ex9000 {
namespace {

// --- loading ---

TEST(SettingsStore, ReadsTheFirstPageOfEachPlaceOfABlankMemoryOnce) {
  FakeMemory memory;
  const Boot run(memory);
  EXPECT_EQ(memory.reads, (std::vector<std::uint16_t>{kCopies[0], kCopies[1]}));
}

TEST(SettingsStore, IsLoadingUntilAllCopiesAreRead) {
  FakeMemory memory;
  SettingsStore store(the_model());
  EXPECT_TRUE(store.loading());
  EXPECT_TRUE(store.busy());
  EXPECT_EQ(store.job().kind, MemoryJob::Kind::Read);
  drive(store, memory);
  EXPECT_FALSE(store.loading());
  EXPECT_FALSE(store.busy());
}

TEST(SettingsStore, RequestsTheSameJobUntilItIsDone) {
  SettingsStore store(the_model());
  const MemoryJob first = store.job();
  const MemoryJob second = store.job();
  EXPECT_EQ(first.kind, second.kind);
  EXPECT_EQ(first.address, second.address);
  EXPECT_EQ(first.bytes.data, second.bytes.data);
  EXPECT_EQ(first.bytes.size, second.bytes.size);
}

TEST(SettingsStore, UsesTheFactorySettingsOfEachModelIfTheMemoryIsBlank) {
  for (const Model& each : kModels) {
    FakeMemory memory;
    const Boot run(memory, each);
    EXPECT_EQ(run.found(), Found::Blank) << each.designation;
    EXPECT_TRUE(run.stored() == Settings::factory(each)) << each.designation;
    EXPECT_TRUE(memory.writes.empty());
  }
}

TEST(SettingsStore, FindsTheOnlyGoodCopyBesideABlankPlace) {
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

TEST(SettingsStore, ACorruptedCopyBesideABlankPlaceIsUnreadable) {
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

TEST(SettingsStore, AReadThatFailsOnceOrTwiceIsRepeated) {
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

TEST(SettingsStore, AReadThatReturnsInvalidDataOnceOrTwiceIsRepeated) {
  for (std::size_t noisy = 1; noisy < kAttempts; ++noisy) {
    FakeMemory memory;
    put(memory, 0, numbered(5), 8);
    put(memory, 1, numbered(6), 7);
    memory.noisy_reads = noisy;
    EXPECT_TRUE(Boot(memory).stored() == numbered(5)) << noisy;
  }
}

TEST(SettingsStore, TheOtherCopyIsUsedIfACopyCannotBeRead) {
  FakeMemory memory;
  put(memory, 0, numbered(5), 8);
  put(memory, 1, numbered(6), 7);
  memory.failing_reads = kAttempts;
  const Boot run(memory);
  EXPECT_EQ(run.found(), Found::Settings);
  EXPECT_TRUE(run.stored() == numbered(6));
}

TEST(SettingsStore, AfterAnUnreadableCopyANoisyReadOfTheOtherIsRetried) {
  FakeMemory memory;
  put(memory, 0, numbered(5), 8);
  put(memory, 1, numbered(6), 7);
  SettingsStore store(the_model());
  memory.failing_reads = kAttempts;
  for (std::size_t i = 0; i < kAttempts; ++i) {
    store.done(*memory.run(store.job()));
  }
  memory.noisy_reads = kAttempts - 1;
  drive(store, memory);
  EXPECT_TRUE(store.stored() == numbered(6));
}

TEST(SettingsStore, IfOneCopyIsCorruptAReadOfTheOtherCopyIsRepeatedAfterTwoFailures) {
  FakeMemory memory;
  put(memory, 0, numbered(5), 8);
  corrupt(memory, 0);
  put(memory, 1, numbered(6), 7);
  SettingsStore store(the_model());
  for (std::size_t i = 0; i < kAttempts; ++i) {
    const MemoryJob job = store.job();
    store.done(*memory.run(job));
  }
  memory.failing_reads = kAttempts - 1;
  drive(store, memory);
  EXPECT_TRUE(store.stored() == numbered(6));
}

TEST(SettingsStore, AMemoryThatDoesNotAnswerIsUnreadable) {
  FakeMemory memory;
  memory.failing_reads = kReadsOfASilentMemory;
  const Boot run(memory);
  EXPECT_EQ(run.found(), Found::Unreadable);
  EXPECT_TRUE(run.stored() == factory());
  EXPECT_EQ(memory.reads.size(), kReadsOfASilentMemory);
}

// --- saving ---

TEST(SettingsStore, SavedSettingsAreFoundAtTheNextLoad) {
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

TEST(SettingsStore, ASaveWritesOnlyTheBytesOfItsRecord) {
  constexpr std::size_t kSize = 4 + 51 + 4;  // layout, length and sequence; settings with filters; CRC
  const Model& inputs = model("EX9053D-M");
  Settings settings = Settings::factory(inputs);
  settings.input_filters.set(0, 1);
  FakeMemory memory;
  Boot run(memory, inputs);
  EXPECT_TRUE(run.save(settings));
  EXPECT_EQ(memory.bytes_written, kSize);
  EXPECT_TRUE(Boot(memory, inputs).stored() == settings);
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

TEST(SettingsStore, ASaveDoesNotWriteTheCopyThatHoldsTheOldSettings) {
  for (const std::size_t current : {0U, 1U}) {
    FakeMemory memory;
    put(memory, current, numbered(5), 8);
    put(memory, 1 - current, numbered(6), 7);
    EXPECT_TRUE(Boot(memory).save(numbered(9)));
    EXPECT_EQ(memory.writes, std::vector<std::uint16_t>{kCopies[1 - current]});
  }
}

TEST(SettingsStore, ASaveOverwritesACorruptedCopyAndNotTheGoodOne) {
  for (const std::size_t good : {0U, 1U}) {
    FakeMemory memory;
    put(memory, good, numbered(5), 8);
    put(memory, 1 - good, numbered(6), 9);
    corrupt(memory, 1 - good);
    EXPECT_TRUE(Boot(memory).save(numbered(9)));
    EXPECT_EQ(memory.writes, std::vector<std::uint16_t>{kCopies[1 - good]});
    EXPECT_TRUE(Boot(memory).stored() == numbered(9));
  }
}

TEST(SettingsStore, ASaveReplacesCorruptSettings) {
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

TEST(SettingsStore, SeveralSavesWithoutAResetBetweenThemWrapTheSequenceToo) {
  FakeMemory memory;
  put(memory, 1, numbered(1000), 0xFFFE);
  Boot run(memory);
  for (unsigned i = 0; i < 5; ++i) {
    EXPECT_TRUE(run.save(numbered(i)));
    EXPECT_TRUE(Boot(memory).stored() == numbered(i)) << i;
  }
}

// A valid reply means that the settings are stored, even if the memory did not answer at reset.
TEST(SettingsStore, SettingsSavedAfterTheMemoryDidNotAnswerAtResetAreFoundAtTheNextLoad) {
  FakeMemory memory;
  put(memory, 0, numbered(5), 700);
  put(memory, 1, numbered(6), 701);
  memory.failing_reads = kReadsOfASilentMemory;
  Boot run(memory);
  ASSERT_EQ(run.found(), Found::Unreadable);
  EXPECT_TRUE(run.save(numbered(9)));
  EXPECT_TRUE(Boot(memory).stored() == numbered(9));
}

TEST(SettingsStore, IfAReadBeforeASaveFailsOnceOrTwiceItIsRepeated) {
  for (std::size_t failing = 1; failing < kAttempts; ++failing) {
    FakeMemory memory;
    put(memory, 0, numbered(5), 700);
    memory.failing_reads = kReadsOfASilentMemory;
    Boot run(memory);
    ASSERT_EQ(run.found(), Found::Unreadable);
    memory.failing_reads = failing;
    EXPECT_TRUE(run.save(numbered(9))) << failing;
    EXPECT_TRUE(Boot(memory).stored() == numbered(9)) << failing;
  }
}

// --- firmware/extensions.md: registers 0x0305 and 0x0306 ---

using Source = SettingsStore::Source;

Source source_of(FakeMemory& memory) {
  SettingsStore store(the_model());
  drive(store, memory);
  return store.source();
}

TEST(SettingsSource, ReportsTheStateOfTheCopies) {
  FakeMemory memory;
  EXPECT_EQ(source_of(memory), Source::Blank);
  put(memory, 0, numbered(5), 7);
  EXPECT_EQ(source_of(memory), Source::Good);  // the other place is blank
  put(memory, 1, numbered(6), 8);
  EXPECT_EQ(source_of(memory), Source::Good);
  corrupt(memory, 0);
  EXPECT_EQ(source_of(memory), Source::OneCopyBad);
  corrupt(memory, 1);
  EXPECT_EQ(source_of(memory), Source::NoneGood);
}

TEST(SettingsSource, StaysTheSameAfterASave) {
  FakeMemory memory;
  SettingsStore store(the_model());
  drive(store, memory);
  store.begin_saving(numbered(5));
  drive(store, memory);
  EXPECT_EQ(store.source(), Source::Blank);
  EXPECT_EQ(source_of(memory), Source::Good);
}

TEST(SettingsSaves, CountOnlySavesThatSucceed) {
  FakeMemory memory;
  SettingsStore store(the_model());
  drive(store, memory);
  EXPECT_EQ(store.saves(), 0U);
  store.begin_saving(numbered(5));
  EXPECT_EQ(store.saves(), 0U);
  drive(store, memory);
  EXPECT_EQ(store.saves(), 1U);
  memory.stuck = true;
  store.begin_saving(numbered(6));
  drive(store, memory);
  EXPECT_EQ(store.saves(), 1U);
}

TEST(SettingsSaves, StopCountingAt65535) {
  FakeMemory memory;
  SettingsStore store(the_model());
  drive(store, memory);
  for (unsigned i = 0; i < 65'540; ++i) {
    store.begin_saving(numbered(i));
    drive(store, memory);
    memory.reads.clear();
    memory.writes.clear();
  }
  EXPECT_EQ(store.saves(), 65'535U);
}

}  // namespace
}  // namespace ex9000
