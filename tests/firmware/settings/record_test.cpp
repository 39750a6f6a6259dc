// Tests records of settings: a written record is read back and has the documented layout, and other data is
// not accepted as settings (wire.md D8).
#include "firmware/settings/record.hpp"

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <random>

#include "tests/firmware/settings/record_bench.hpp"

namespace ex9000 {
namespace {

void expect_round_trip(const Model& which, const Stored& stored) {
  const std::optional<StoredSettings> found = read(which, record_of(stored, which));
  ASSERT_TRUE(found) << which.designation;
  EXPECT_TRUE(found->settings == stored.settings) << which.designation;
  EXPECT_EQ(found->sequence, stored.sequence) << which.designation;
}

// --- written records are read back ---

TEST(Record, ARecordOfFactorySettingsFitsInAPageOfTheMemory) {
  EXPECT_EQ(record_of(factory()).size(), kRecordSize);
  EXPECT_LE(kRecordSize, 32U);
}

TEST(Record, FactorySettingsOfEveryModelAreReadBack) {
  for (const Model& each : kModels) {
    expect_round_trip(each, {Settings::factory(each), 0});
  }
}

TEST(Record, EveryFieldUpToTheSafeValueIsReadBack) { expect_round_trip(the_model(), changed_settings()); }

TEST(Record, RandomSettingsOfEveryModelAreReadBack) {
  std::mt19937 random(1);
  for (const Model& each : kModels) {
    for (int i = 0; i < 1000; ++i) {
      expect_round_trip(each, random_settings(each, random));
    }
  }
}

TEST(Record, EachWatchdogFlagIsReadBackIfOnlyThisFlagIsSet) {
  Stored stored = factory();
  stored.settings.watchdog_enabled = true;
  expect_round_trip(the_model(), stored);
  stored.settings.watchdog_enabled = false;
  stored.settings.timeout_status = true;
  expect_round_trip(the_model(), stored);
}

TEST(Record, SequenceNumbersOfTheWholeRangeAreReadBack) {
  Stored stored = factory();
  for (unsigned sequence = 0; sequence < 0x10000; sequence += 0xFF) {
    stored.sequence = static_cast<std::uint16_t>(sequence);
    expect_round_trip(the_model(), stored);
  }
}

TEST(Record, TheLongestNameIsReadBack) {
  Stored stored{Settings::factory(model("EX9068D-M")), 1};
  stored.settings.name = Name("ABCDEFG");
  expect_round_trip(model("EX9068D-M"), stored);
}

// --- the layout ---

TEST(Record, HasTheDocumentedLayout) {
  const Record changed{
      1,    19,   0xEF, 0xBE,                   // layout, length, sequence
      0xF7, 0x0A, 0xC0, 1,    0x64, 1,   1,     // address to timeout status
      'p',  'u',  'm',  'p',  '~',  '1', 0, 6,  // name
      0x5C, 0x1A, 0xFF, 0x03,                   // power-on value, safe value
      0x73, 0xEA, 0x60, 0xA3,                   // check
  };
  EXPECT_EQ(record_of(changed_settings()), changed);
  const Record from_the_factory{
      1,    19,   1,    0,                    //
      1,    6,    0,    1,    0xFF, 0, 0,     //
      '9',  '0',  '4',  '2',  'M',  0, 0, 5,  //
      0,    0,    0,    0,                    //
      0xA5, 0xB3, 0xBF, 0xDE,
  };
  EXPECT_EQ(record_of(factory()), from_the_factory);
}

TEST(Record, HasTheDocumentedLayoutOfTheExtensions) {
  const Model& sixteen_inputs = model("EX9053D");
  Stored stored{Settings::factory(sixteen_inputs), 1};
  stored.settings.input_filters.set(0, 2000);
  stored.settings.input_filters.set(15, 3);
  stored.settings.inverted_inputs = 0x8001;
  stored.settings.fed_by_requests = true;
  stored.settings.response_delay = 30;
  stored.settings.serial_number = 0x0D001234;
  Record expected{1, 59, 1, 0, 1, 6, 0, 0, 0xFF, 0, 0, '9', '0', '5', '3', 0, 0, 0, 4, 0, 0, 0, 0};
  expected.insert(expected.end(), {0xD0, 0x07});                       // filter of input 0
  expected.resize(expected.size() + 28);                               // inputs 1 to 14
  expected.insert(expected.end(), {3, 0, 0x01, 0x80, 1, 30});          // input 15, other settings
  expected.insert(expected.end(), {0x34, 0x12, 0, 0x0D, 0, 0, 0, 0});  // serial number, check
  EXPECT_EQ(record_of(stored, sixteen_inputs), with_check(sixteen_inputs, expected));
  expect_round_trip(sixteen_inputs, stored);
}

TEST(Record, HasTheDocumentedCheck) {
  std::mt19937 random(2);
  for (const Model& each : kModels) {
    for (int i = 0; i < 1000; ++i) {
      const Record record = record_of(random_settings(each, random), each);
      ASSERT_EQ(record, with_check(each, record)) << each.designation;
    }
  }
}

// --- contents that are not settings of the model ---

TEST(Record, ARecordOfAnotherModelIsInvalid) {
  for (const Model& writer : kModels) {
    const Record record = record_of({Settings::factory(writer), 1}, writer);
    for (const Model& reader : kModels) {
      EXPECT_EQ(is_good(reader, record), &reader == &writer)
          << writer.designation << " read by " << reader.designation;
    }
  }
}

TEST(Record, MemoryWithTheSameValueInAllBytesIsNotARecord) {
  for (unsigned value = 0; value < 256; ++value) {
    const Record record = filled_with(static_cast<std::uint8_t>(value));
    EXPECT_FALSE(is_good(the_model(), record)) << value;
    EXPECT_FALSE(is_good(the_model(), with_check(the_model(), record))) << value;
  }
}

TEST(Record, ARecordWithImpossibleSettingsOrAnotherLayoutIsInvalidDespiteACorrectCheck) {
  struct Bad {
    const char* what;
    std::size_t at;
    std::uint8_t value;
  };
  const Record good = record_of(factory());
  for (const Bad& bad : {Bad{"Modbus address", 4, 0},
                         Bad{"Modbus address", 4, 248},
                         Bad{"baud code", 5, 2},
                         Bad{"baud code", 5, 0x0B},
                         Bad{"format", 6, 0x20},
                         Bad{"protocol", 7, 2},
                         Bad{"protocol", 7, 0xFF},
                         Bad{"watchdog enabled", 9, 2},
                         Bad{"watchdog enabled", 9, 0xFF},
                         Bad{"timeout status", 10, 2},
                         Bad{"timeout status", 10, 0x80},
                         Bad{"name", 11, 0x0D},
                         Bad{"name", 15, 0x7F},
                         Bad{"no name", 18, 0},
                         Bad{"long name", 18, 7},
                         Bad{"longer name", 18, 8},
                         Bad{"longest name", 18, 255},
                         Bad{"power-on value", 20, 0x20},
                         Bad{"safe value", 22, 0x80},
                         Bad{"layout", 0, 0},
                         Bad{"layout", 0, 2}}) {
    Record record = good;
    record[bad.at] = bad.value;
    EXPECT_FALSE(is_good(the_model(), with_check(the_model(), record))) << bad.what;
  }
  EXPECT_TRUE(is_good(the_model(), with_check(the_model(), good)));
}

TEST(Record, ARecordWithAnEnabledWatchdogAndTimeout0IsInvalid) {
  Record record = record_of(changed_settings());
  record[8] = 0;
  EXPECT_FALSE(is_good(the_model(), with_check(the_model(), record)));
}

}  // namespace
}  // namespace ex9000
