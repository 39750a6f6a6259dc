// Tests records of different lengths, for example records of firmware with more or fewer settings. Also tests
// which of two copies is newer.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

#include "tests/firmware/settings/record_bench.hpp"
#include "tests/support/stored_settings.hpp"

namespace ex9000 {
namespace {

constexpr std::size_t kSupported = StoredCopy::bytes_of_all();

/// Returns a record with `length` bytes of settings, which may be fewer or more than this firmware supports.
/// The settings up to the safe value are those of `stored`. The other supported settings have their factory
/// values. The bytes after them, which firmware with more settings would use, have arbitrary values.
Record with_length(const Stored& stored, std::size_t length) {
  Record record = record_of(stored);
  Record settings(record.begin() + kSettingsAt, record.begin() + kCheckAt);
  for (std::size_t more = settings.size(); more < length; ++more) {
    settings.push_back(later_byte(more));
  }
  settings.resize(length);
  record.resize(kSettingsAt);
  record[kLengthAt] = static_cast<std::uint8_t>(length);
  record.insert(record.end(), settings.begin(), settings.end());
  record.resize(record.size() + 4);
  return with_check(the_model(), record);
}

TEST(Record, HasRoomForUpTo120BytesOfSettings) {
  for (std::size_t length = kSettingsSize; length <= 120; ++length) {
    const std::optional<StoredSettings> found = read(the_model(), with_length(changed_settings(), length));
    ASSERT_TRUE(found) << length;
    EXPECT_TRUE(found->settings == changed_settings().settings) << length;
  }
}

TEST(Record, ARecordThatIsLongerThanItsPlaceIsInvalid) {
  for (std::size_t length = 121; length <= 255; ++length) {
    const Record record = with_length(changed_settings(), length);
    EXPECT_EQ(record_size({record.data(), record.size()}), 0U) << length;
    EXPECT_FALSE(is_good(the_model(), record)) << length;
  }
}

TEST(Record, AnIncompleteRecordIsNotRead) {
  const Record record = with_length(changed_settings(), 60);
  for (std::size_t size = kSettingsAt; size < record.size(); ++size) {
    EXPECT_FALSE(read_record(the_model(), {record.data(), size})) << size;
  }
}

TEST(Record, MissingLastSettingsHaveTheirFactoryValues) {
  Settings expected = changed_settings().settings;
  const auto found = [](std::size_t length) {
    return read(the_model(), with_length(changed_settings(), length)).value().settings;
  };
  expected.safe_value = 0;
  EXPECT_TRUE(found(18) == expected);
  EXPECT_TRUE(found(17) == expected);
  expected.power_on_value = 0;
  EXPECT_TRUE(found(16) == expected);
  EXPECT_TRUE(found(15) == expected);
  expected.name = Name(std::string_view("9042M"));
  EXPECT_TRUE(found(14) == expected);
  EXPECT_TRUE(found(7) == expected);
  expected.timeout_status = false;
  EXPECT_TRUE(found(6) == expected);
  EXPECT_TRUE(found(0) == Settings::factory(the_model()));
}

TEST(Record, ARecordWrittenOverALongerOneKeepsTheUnknownSettings) {
  for (std::size_t length = kSupported + 1; length <= 120; ++length) {
    const Record longer = with_length(factory(), length);
    RecordBytes bytes{};
    std::copy(longer.begin(), longer.end(), bytes.begin());
    write_record(the_model(), changed_settings().settings, changed_settings().sequence, bytes);
    const Record written(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(longer.size()));
    EXPECT_EQ(written, with_length(changed_settings(), length)) << length;
  }
}

TEST(Record, EndsAfterTheLastExtensionThatDiffersFromItsFactoryValue) {
  Stored stored = factory();
  EXPECT_EQ(record_of(stored).size(), kRecordSize);
  stored.settings.fed_by_requests = true;
  EXPECT_EQ(record_of(stored).size(), kRecordSize + 35);
  stored.settings.response_delay = 30;
  EXPECT_EQ(record_of(stored).size(), kRecordSize + 36);
  stored.settings.fed_by_requests = false;
  EXPECT_EQ(record_of(stored).size(), kRecordSize + 36);
  stored.settings.serial_number = 0x0D000000;
  EXPECT_EQ(record_of(stored).size(), kRecordSize + 40);
  Stored of_inputs{Settings::factory(model("EX9052D-M")), 1};
  of_inputs.settings.input_filters.set(0, 1);
  EXPECT_EQ(record_of(of_inputs, model("EX9052D-M")).size(), kRecordSize + 32);
  of_inputs.settings.inverted_inputs = 0x80;
  EXPECT_EQ(record_of(of_inputs, model("EX9052D-M")).size(), kRecordSize + 34);
}

TEST(Record, ARecordWrittenOverOneWithMoreSettingsIsShortAgain) {
  Stored stored = factory();
  stored.settings.response_delay = 5;
  RecordBytes bytes{};
  write_record(the_model(), stored.settings, stored.sequence, bytes);
  write_record(the_model(), factory().settings, factory().sequence, bytes);
  EXPECT_EQ(record_size({bytes.data(), bytes.size()}), kRecordSize);
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.begin() + kRecordSize, record_of(factory()).begin()));
}

TEST(Record, ARecordWrittenOverAShorterOneIsComplete) {
  const Record shorter = with_length(changed_settings(), 7);
  RecordBytes bytes{};
  std::copy(shorter.begin(), shorter.end(), bytes.begin());
  write_record(the_model(), changed_settings().settings, changed_settings().sequence, bytes);
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.begin() + kRecordSize, record_of(changed_settings()).begin()));
}

// --- the newer of two copies ---

TEST(Sequence, ALaterOneIsLaterAcrossTheWrap) {
  for (unsigned from = 0; from < 0x10000; from += 0x1FF) {
    const auto older = static_cast<std::uint16_t>(from);
    for (const unsigned ahead : {1U, 2U, 0x7FFFU}) {
      const auto newer = static_cast<std::uint16_t>(from + ahead);
      EXPECT_TRUE(is_later(newer, older));
      EXPECT_FALSE(is_later(older, newer));
    }
    EXPECT_FALSE(is_later(older, older));
    const auto opposite = static_cast<std::uint16_t>(from + 0x8000);
    EXPECT_FALSE(is_later(opposite, older));
    EXPECT_FALSE(is_later(older, opposite));
  }
}

}  // namespace
}  // namespace ex9000
