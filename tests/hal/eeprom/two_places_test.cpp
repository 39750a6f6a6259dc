// Tests how the settings are loaded from an EEPROM and saved there: wire.md section 8, "A valid reply means
// that the settings are stored."
#include "hal/eeprom/two_places.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <utility>
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

constexpr unsigned kBlank = 0;
constexpr unsigned kFactory = 0;

/// The content of one place.
struct Copy {
  unsigned number = kBlank;  ///< of the settings
  std::uint16_t sequence = 0;
  bool good = true;
};
struct Load {
  const char* what;
  Copy one;
  Copy other;
  unsigned found;  ///< number of the settings
  SettingsSource source;
};
/// firmware/extensions.md, register 0x0306, lists the sources.
constexpr Load kLoads[] = {
    {"a blank memory", {}, {}, kFactory, SettingsSource::Blank},
    {"a good copy beside a blank place", {5, 7}, {}, 5, SettingsSource::Good},
    {"a good copy beside a corrupted one", {5, 7}, {6, 8, false}, 5, SettingsSource::OneCopyBad},
    {"the later of two good copies", {5, 8}, {6, 7}, 5, SettingsSource::Good},
    {"sequence 0 is later than FFFF", {5, 0}, {6, 0xFFFF}, 5, SettingsSource::Good},
    {"two corrupted copies", {5, 7, false}, {6, 8, false}, kFactory, SettingsSource::NoneGood},
    {"a corrupted copy beside a blank place", {5, 7, false}, {}, kFactory, SettingsSource::NoneGood},
};

TEST(TwoPlaces, FindsTheLatestGoodCopyInEitherPlaceAndReportsTheState) {
  for (const Load& load : kLoads) {
    for (const std::size_t place : {0U, 1U}) {
      SCOPED_TRACE(load.what);
      FakeEeprom memory;
      for (const auto& [copy, at] : {std::pair(load.one, place), std::pair(load.other, 1 - place)}) {
        if (copy.number != kBlank) {
          put(memory, at, numbered(copy.number), copy.sequence);
        }
        if (!copy.good) {
          corrupt(memory, at);
        }
      }
      const Boot run(memory);
      EXPECT_EQ(run.source(), load.source);
      EXPECT_TRUE(run.stored() == (load.found == kFactory ? factory() : numbered(load.found)));
      EXPECT_TRUE(memory.writes.empty());
    }
  }
}

TEST(TwoPlaces, SettingsOfAnotherModelAreUnreadable) {
  FakeEeprom memory;
  put(memory, 0, Settings::factory(model("EX9043D-M")), 7, model("EX9043D-M"));
  const Boot run(memory);
  EXPECT_EQ(run.source(), SettingsSource::NoneGood);
  EXPECT_TRUE(run.stored() == factory());
}

TEST(TwoPlaces, AReadThatFailsOrReturnsInvalidDataOnceOrTwiceIsRepeated) {
  for (std::size_t FakeEeprom::*const failure : {&FakeEeprom::failing_reads, &FakeEeprom::noisy_reads}) {
    for (std::size_t times = 1; times < kAttempts; ++times) {
      FakeEeprom memory;
      put(memory, 0, numbered(5), 8);
      put(memory, 1, numbered(6), 7);
      memory.*failure = times;
      EXPECT_TRUE(Boot(memory).stored() == numbered(5)) << times;
      EXPECT_EQ(memory.reads.size(), times + 2);
    }
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

TEST(TwoPlaces, SavesAlternateBetweenTheCopiesAlsoAcrossResets) {
  for (const bool resets : {false, true}) {
    FakeEeprom memory;
    Boot run(memory);
    for (unsigned i = 1; i <= 6; ++i) {
      EXPECT_TRUE(resets ? Boot(memory).save(numbered(i)) : run.save(numbered(i)));
      EXPECT_TRUE(Boot(memory).stored() == numbered(i));
    }
    for (std::size_t i = 1; i < memory.writes.size(); ++i) {
      EXPECT_NE(memory.writes[i], memory.writes[i - 1]);
    }
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

}  // namespace
}  // namespace ex9000
