// Tests the settings keeper with a record of newer firmware, which is longer than this firmware would write.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "tests/hal/eeprom/two_places_bench.hpp"

namespace ex9000 {
namespace {

TEST(ALongerRecord, IsReadUpToTheLastKnownSetting) {
  for (unsigned length = 20; length <= 120; ++length) {
    FakeEeprom memory;
    put_longer(memory, 0, numbered(5), 7, static_cast<std::uint8_t>(length));
    const Boot run(memory);
    EXPECT_EQ(run.source(), SettingsSource::Good) << length;
    EXPECT_TRUE(run.stored() == numbered(5)) << length;
  }
}

TEST(ALongerRecord, KeepsUnknownSettingsAfterEachSave) {
  for (unsigned length = StoredCopy::bytes_of_all() + 1; length <= 120; ++length) {
    FakeEeprom memory;
    put_longer(memory, 0, numbered(5), 7, static_cast<std::uint8_t>(length));
    Boot run(memory);
    for (unsigned store = 0; store < 3; ++store) {
      ASSERT_TRUE(run.save(numbered(10 + store))) << length;
    }
    FakeEeprom expected;
    put_longer(expected, 1, numbered(12), 10, static_cast<std::uint8_t>(length));
    const auto copy = [length](const FakeEeprom& of) {
      const auto begin = of.cells.begin() + kCopies[1];
      return std::vector<std::uint8_t>(begin, begin + 4 + static_cast<std::ptrdiff_t>(length) + 4);
    };
    EXPECT_EQ(copy(memory), copy(expected)) << length;
    EXPECT_TRUE(Boot(memory).stored() == numbered(12)) << length;
  }
}

TEST(ALongerRecord, KeepsUnknownSettingsAfterAFailedSave) {
  FakeEeprom memory;
  put_longer(memory, 0, numbered(5), 7, 96);
  Boot run(memory);
  memory.noisy_reads = kAttempts;
  EXPECT_FALSE(run.save(numbered(6)));
  EXPECT_TRUE(Boot(memory).stored() == numbered(5));
  EXPECT_TRUE(run.save(numbered(7)));
  FakeEeprom expected;
  put_longer(expected, 1, numbered(7), 9, 96);  // 8 is that of the refused record
  EXPECT_TRUE(std::equal(memory.cells.begin() + kCopies[1], memory.cells.begin() + kCopies[1] + 104,
                         expected.cells.begin() + kCopies[1]));
}

TEST(ALongerRecord, IsWrittenPageByPageAndOnlyUpToItsEnd) {
  FakeEeprom memory;
  put_longer(memory, 0, numbered(5), 7, 96);  // 104 bytes
  EXPECT_TRUE(Boot(memory).save(numbered(6)));
  EXPECT_EQ(memory.writes, (std::vector<std::uint16_t>{0x80, 0xA0, 0xC0, 0xE0}));
  memory.writes.clear();
  FakeEeprom shorter;
  put_longer(shorter, 0, numbered(5), 7, 88);  // 96 bytes
  EXPECT_TRUE(Boot(shorter).save(numbered(6)));
  EXPECT_EQ(shorter.writes, (std::vector<std::uint16_t>{0x80, 0xA0, 0xC0}));
}

TEST(ALongerRecord, IsInvalidIfAnyByteIsWrong) {
  FakeEeprom good;
  put_longer(good, 0, numbered(5), 7, 96);
  put(good, 1, numbered(6), 6);
  for (std::size_t at = 0; at < 104; ++at) {
    FakeEeprom memory = good;
    memory.cells[kCopies[0] + at] ^= 0x04U;
    EXPECT_TRUE(Boot(memory).stored() == numbered(6)) << at;
  }
}

TEST(ALongerRecord, IsRefusedIfOnePageFailsThreeTimesAndTheOldRecordStays) {
  for (std::size_t page = 0; page < 4; ++page) {
    FakeEeprom memory;
    put_longer(memory, 0, numbered(5), 7, 96);
    Boot run(memory);
    memory.good_jobs = 2 * page;
    memory.unanswered_writes = kAttempts;
    EXPECT_FALSE(run.save(numbered(6))) << page;
    EXPECT_TRUE(Boot(memory).stored() == numbered(5)) << page;
  }
}

}  // namespace
}  // namespace ex9000
