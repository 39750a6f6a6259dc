// Tests how the settings are loaded from an EEPROM and saved there: wire.md section 8, "A valid reply means
// that the settings are stored."
#include "hal/eeprom/two_places.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/hal/eeprom/two_places_bench.hpp"

namespace ex9000 {
namespace {

// --- loading ---

TEST(TwoPlaces, ReadsTheFirstPageOfEachPlaceOfABlankMemoryOnce) {
  FakeEeprom memory;
  const Boot run(memory);
  EXPECT_EQ(memory.reads, (std::vector<std::uint16_t>{kCopies[0], kCopies[1]}));
}

TEST(TwoPlaces, UsesTheFactorySettingsOfEachModelIfTheMemoryIsBlank) {
  for (const Model& each : kModels) {
    FakeEeprom memory;
    const Boot run(memory, each);
    EXPECT_EQ(run.source(), SettingsSource::Blank) << each.designation;
    EXPECT_TRUE(run.stored() == Settings::factory(each)) << each.designation;
    EXPECT_TRUE(memory.writes.empty());
  }
}

TEST(TwoPlaces, FindsTheOnlyGoodCopyBesideABlankPlace) {
  for (const std::size_t copy : {0U, 1U}) {
    FakeEeprom memory;
    put(memory, copy, numbered(5), 7);
    const Boot run(memory);
    EXPECT_TRUE(run.stored() == numbered(5));
  }
}

TEST(TwoPlaces, FindsTheOnlyGoodCopyBesideACorruptedOne) {
  for (const std::size_t copy : {0U, 1U}) {
    FakeEeprom memory;
    put(memory, copy, numbered(5), 7);
    put(memory, 1 - copy, numbered(6), 8);
    corrupt(memory, 1 - copy);
    const Boot run(memory);
    EXPECT_TRUE(run.stored() == numbered(5));
    EXPECT_TRUE(memory.writes.empty());
  }
}

TEST(TwoPlaces, FindsTheLaterOfTwoGoodCopies) {
  for (const std::size_t later : {0U, 1U}) {
    FakeEeprom memory;
    put(memory, later, numbered(5), 8);
    put(memory, 1 - later, numbered(6), 7);
    EXPECT_TRUE(Boot(memory).stored() == numbered(5));
  }
}

TEST(TwoPlaces, Sequence0IsLaterThanFFFF) {
  for (const std::size_t later : {0U, 1U}) {
    FakeEeprom memory;
    put(memory, later, numbered(5), 0x0000);
    put(memory, 1 - later, numbered(6), 0xFFFF);
    EXPECT_TRUE(Boot(memory).stored() == numbered(5));
  }
}

TEST(TwoPlaces, TwoCorruptedCopiesAreUnreadableAndStayAsTheyAre) {
  FakeEeprom memory;
  put(memory, 0, numbered(5), 7);
  put(memory, 1, numbered(6), 8);
  corrupt(memory, 0);
  corrupt(memory, 1);
  const Boot run(memory);
  EXPECT_EQ(run.source(), SettingsSource::NoneGood);
  EXPECT_TRUE(run.stored() == factory());
  EXPECT_TRUE(memory.writes.empty());
}

TEST(TwoPlaces, ACorruptedCopyBesideABlankPlaceIsUnreadable) {
  for (const std::size_t copy : {0U, 1U}) {
    FakeEeprom memory;
    put(memory, copy, numbered(5), 7);
    corrupt(memory, copy);
    const Boot run(memory);
    EXPECT_EQ(run.source(), SettingsSource::NoneGood);
    EXPECT_TRUE(run.stored() == factory());
  }
}

TEST(TwoPlaces, SettingsOfAnotherModelAreUnreadable) {
  FakeEeprom memory;
  put(memory, 0, Settings::factory(model("EX9043D-M")), 7, model("EX9043D-M"));
  put(memory, 1, Settings::factory(model("EX9043D-M")), 8, model("EX9043D-M"));
  const Boot run(memory);
  EXPECT_EQ(run.source(), SettingsSource::NoneGood);
  EXPECT_TRUE(run.stored() == factory());
}

TEST(TwoPlaces, AReadThatFailsOnceOrTwiceIsRepeated) {
  for (std::size_t failing = 1; failing < kAttempts; ++failing) {
    FakeEeprom memory;
    put(memory, 0, numbered(5), 8);
    put(memory, 1, numbered(6), 7);
    memory.failing_reads = failing;
    const Boot run(memory);
    EXPECT_TRUE(run.stored() == numbered(5)) << failing;
    EXPECT_EQ(memory.reads.size(), failing + 2);
  }
}

TEST(TwoPlaces, AReadThatReturnsInvalidDataOnceOrTwiceIsRepeated) {
  for (std::size_t noisy = 1; noisy < kAttempts; ++noisy) {
    FakeEeprom memory;
    put(memory, 0, numbered(5), 8);
    put(memory, 1, numbered(6), 7);
    memory.noisy_reads = noisy;
    EXPECT_TRUE(Boot(memory).stored() == numbered(5)) << noisy;
  }
}

TEST(TwoPlaces, TheOtherCopyIsUsedIfACopyCannotBeRead) {
  FakeEeprom memory;
  put(memory, 0, numbered(5), 8);
  put(memory, 1, numbered(6), 7);
  memory.failing_reads = kAttempts;
  const Boot run(memory);
  EXPECT_TRUE(run.stored() == numbered(6));
}

TEST(TwoPlaces, AfterAnUnreadableOrCorruptCopyABadReadOfTheOtherIsRepeated) {
  FakeEeprom memory;
  put(memory, 0, numbered(5), 8);
  put(memory, 1, numbered(6), 7);
  FakeEeprom unreadable = memory;
  unreadable.failing_reads = kAttempts;
  unreadable.noisy_reads = kAttempts - 1;  // a read that gets no answer is not noisy
  EXPECT_TRUE(Boot(unreadable).stored() == numbered(6));
  EXPECT_EQ(unreadable.reads.size(), 2 * kAttempts);
  FakeEeprom corrupted = memory;
  corrupt(corrupted, 0);
  corrupted.good_jobs = kAttempts;
  corrupted.failing_reads = kAttempts - 1;
  EXPECT_TRUE(Boot(corrupted).stored() == numbered(6));
  EXPECT_EQ(corrupted.reads.size(), 2 * kAttempts);
}

TEST(TwoPlaces, AMemoryThatDoesNotAnswerIsUnreadable) {
  FakeEeprom memory;
  memory.failing_reads = kReadsOfASilentEeprom;
  const Boot run(memory);
  EXPECT_EQ(run.source(), SettingsSource::NoneGood);
  EXPECT_TRUE(run.stored() == factory());
  EXPECT_EQ(memory.reads.size(), kReadsOfASilentEeprom);
}

// --- saving ---

TEST(TwoPlaces, SavedSettingsAreFoundAtTheNextLoad) {
  FakeEeprom memory;
  Boot run(memory);
  EXPECT_TRUE(run.save(numbered(1)));
  EXPECT_TRUE(run.stored() == numbered(1));
  const Boot next(memory);
  EXPECT_EQ(next.source(), SettingsSource::Good);
  EXPECT_TRUE(next.stored() == numbered(1));
}

TEST(TwoPlaces, ASaveWritesOneCopyOnceAndReadsItBack) {
  FakeEeprom memory;
  Boot run(memory);
  memory.reads.clear();
  EXPECT_TRUE(run.save(numbered(1)));
  EXPECT_EQ(memory.writes.size(), 1U);
  EXPECT_EQ(memory.reads, memory.writes);
}

TEST(TwoPlaces, ASaveWritesOnlyTheBytesOfItsRecord) {
  constexpr std::size_t kSize = 4 + 51 + 4;  // layout, length and sequence; settings with filters; CRC
  const Model& inputs = model("EX9053D-M");
  Settings settings = Settings::factory(inputs);
  settings.input_filters.set(0, 1);
  FakeEeprom memory;
  Boot run(memory, inputs);
  EXPECT_TRUE(run.save(settings));
  EXPECT_EQ(memory.bytes_written, kSize);
  EXPECT_TRUE(Boot(memory, inputs).stored() == settings);
}

TEST(TwoPlaces, SavesAlternateBetweenTheCopies) {
  FakeEeprom memory;
  Boot run(memory);
  for (unsigned i = 1; i <= 6; ++i) {
    EXPECT_TRUE(run.save(numbered(i)));
  }
  for (std::size_t i = 1; i < memory.writes.size(); ++i) {
    EXPECT_NE(memory.writes[i], memory.writes[i - 1]);
  }
}

TEST(TwoPlaces, SavesAlternateAcrossResetsToo) {
  FakeEeprom memory;
  for (unsigned i = 1; i <= 6; ++i) {
    EXPECT_TRUE(Boot(memory).save(numbered(i)));
    EXPECT_TRUE(Boot(memory).stored() == numbered(i));
  }
  for (std::size_t i = 1; i < memory.writes.size(); ++i) {
    EXPECT_NE(memory.writes[i], memory.writes[i - 1]);
  }
}

TEST(TwoPlaces, ASaveDoesNotWriteTheCopyThatHoldsTheOldSettings) {
  for (const std::size_t current : {0U, 1U}) {
    FakeEeprom memory;
    put(memory, current, numbered(5), 8);
    put(memory, 1 - current, numbered(6), 7);
    EXPECT_TRUE(Boot(memory).save(numbered(9)));
    EXPECT_EQ(memory.writes, std::vector<std::uint16_t>{kCopies[1 - current]});
  }
}

TEST(TwoPlaces, ASaveOverwritesACorruptedCopyAndNotTheGoodOne) {
  for (const std::size_t good : {0U, 1U}) {
    FakeEeprom memory;
    put(memory, good, numbered(5), 8);
    put(memory, 1 - good, numbered(6), 9);
    corrupt(memory, 1 - good);
    EXPECT_TRUE(Boot(memory).save(numbered(9)));
    EXPECT_EQ(memory.writes, std::vector<std::uint16_t>{kCopies[1 - good]});
    EXPECT_TRUE(Boot(memory).stored() == numbered(9));
  }
}

TEST(TwoPlaces, ASaveReplacesCorruptSettings) {
  FakeEeprom memory;
  put(memory, 0, numbered(5), 700);
  put(memory, 1, numbered(6), 701);
  corrupt(memory, 0);
  corrupt(memory, 1);
  Boot run(memory);
  EXPECT_TRUE(run.save(numbered(9)));
  EXPECT_TRUE(Boot(memory).stored() == numbered(9));
}

TEST(TwoPlaces, SequenceNumbersWrapWithoutLosingASave) {
  FakeEeprom memory;
  put(memory, 0, numbered(1000), 0xFFF8);
  for (unsigned i = 0; i < 20; ++i) {
    EXPECT_TRUE(Boot(memory).save(numbered(i)));
    EXPECT_TRUE(Boot(memory).stored() == numbered(i)) << i;
  }
}

TEST(TwoPlaces, IfAReadBeforeASaveFailsOnceOrTwiceItIsRepeated) {
  for (std::size_t failing = 1; failing < kAttempts; ++failing) {
    FakeEeprom memory;
    put(memory, 0, numbered(5), 700);
    memory.failing_reads = kReadsOfASilentEeprom;
    Boot run(memory);
    ASSERT_EQ(run.source(), SettingsSource::NoneGood);
    memory.failing_reads = failing;
    EXPECT_TRUE(run.save(numbered(9))) << failing;
    EXPECT_TRUE(Boot(memory).stored() == numbered(9)) << failing;
  }
}

// --- firmware/extensions.md: register 0x0306 ---

using Source = SettingsSource;

Source source_of(FakeEeprom& memory) { return Boot(memory).source(); }

TEST(SettingsSource, ReportsTheStateOfTheCopies) {
  FakeEeprom memory;
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

}  // namespace
}  // namespace ex9000
