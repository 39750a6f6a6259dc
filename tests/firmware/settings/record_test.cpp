// Tests the stored form of settings: a written record is read back, and other data is not accepted as
// settings (wire.md D8).
#include "firmware/settings/record.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <random>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace ex9000 {
namespace {

const Model& model(std::string_view designation) { return *find_model(designation); }

/// The contents of a record.
struct Stored {
  Settings settings;
  std::uint16_t sequence;
};

/// Returns settings in which every field differs from its factory value.
Stored changed_settings() {
  Settings settings;
  settings.address = 0xF7;
  settings.baud_code = 0x0A;
  settings.format = 0xC0;
  settings.protocol = Protocol::ModbusRtu;
  settings.name = Name("pump~1");
  settings.power_on_value = 0x1A5C;
  settings.safe_value = 0x03FF;
  settings.watchdog_enabled = true;
  settings.watchdog_timeout = 0x64;
  settings.timeout_status = true;
  return {settings, 0xBEEF};
}

const Model& the_model() { return model("EX9042D-M"); }

Stored factory() { return {Settings::factory(the_model()), 1}; }

using Record = std::vector<std::uint8_t>;

Record record_of(const Stored& stored, const Model& which = the_model()) {
  RecordBytes bytes{};
  write_record(which, stored.settings, stored.sequence, bytes);
  return {bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(record_size({bytes.data(), 4}))};
}

std::optional<StoredSettings> read(const Model& which, const Record& record) {
  return read_record(which, {record.data(), record.size()});
}
bool is_good(const Model& which, const Record& record) { return read(which, record).has_value(); }

void expect_round_trip(const Model& which, const Stored& stored) {
  const std::optional<StoredSettings> found = read(which, record_of(stored, which));
  ASSERT_TRUE(found) << which.designation;
  EXPECT_TRUE(found->settings == stored.settings) << which.designation;
  EXPECT_EQ(found->edition.sequence, stored.sequence) << which.designation;
  EXPECT_EQ(found->edition.layout, 3) << which.designation;
}

// The layout: firmware/settings/record.hpp.
constexpr std::size_t kLengthAt = 1;
constexpr std::size_t kSettingsAt = 4;
constexpr std::size_t kSettingsSize = 19;
constexpr std::size_t kCheckAt = kSettingsAt + kSettingsSize;
constexpr std::size_t kRecordSize = kCheckAt + 4;

Record filled_with(std::uint8_t byte) { return Record(kRecordSize, byte); }

/// Returns the first `written` bytes of `newer`, followed by the rest of `older`.
Record torn_record(const Record& newer, std::size_t written, Record older) {
  std::copy_n(newer.begin(), written, older.begin());
  return older;
}

constexpr std::size_t kRecordBits = kRecordSize * 8;

Record with_flipped(Record record, std::size_t bit) {
  record[bit / 8] = static_cast<std::uint8_t>(record[bit / 8] ^ (1U << (bit % 8)));
  return record;
}

// --- the check: CRC-32 of IEEE 802.3, bit by bit, forwards and backwards ---

std::uint32_t word_at(const Record& record, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    word += std::uint32_t{record[at + i]} << (8 * i);
  }
  return word;
}

std::uint32_t check_in(const Record& record) { return word_at(record, record.size() - 4); }

constexpr std::uint32_t kReflectedPolynomial = 0xEDB8'8320U;

std::uint32_t taken_in(std::uint32_t crc, std::uint32_t data, int bits) {
  for (; bits > 0; --bits, data >>= 1U) {
    const bool divides = ((crc ^ data) & 1U) != 0;
    crc = divides ? (crc >> 1U) ^ kReflectedPolynomial : crc >> 1U;
  }
  return crc;
}

/// The inverse of `taken_in`: returns the exclusive or of CRC and data from which `taken_in` computed
/// `result`. The highest bit of the polynomial shows in which steps it was applied.
std::uint32_t undone(std::uint32_t result, int bits) {
  for (int bit = 0; bit < bits; ++bit) {
    const bool divided = result >> 31U != 0;
    result = divided ? (result ^ kReflectedPolynomial) << 1U | 1U : result << 1U;
  }
  return result;
}

std::uint32_t seed(const Model& which) {
  std::uint32_t crc = 0xFFFF'FFFFU;
  for (const char character : which.designation) {
    crc = taken_in(crc, static_cast<unsigned char>(character), 8);
  }
  return crc;
}

/// Sets a correct check, so that a test can store contents that no module would store.
Record with_check(const Model& which, Record record) {
  const std::size_t check_at = record.size() - 4;
  std::uint32_t crc = seed(which);
  for (std::size_t i = 0; i < check_at; ++i) {
    crc = taken_in(crc, record[i], 8);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    record[check_at + i] = static_cast<std::uint8_t>(~crc >> (8 * i));
  }
  return record;
}

/// Returns the only four bytes from `missing` on that match the check and the other bytes of the record.
std::uint32_t word_that_must_be_at(std::size_t missing, const Record& record, const Model& which) {
  std::uint32_t behind = ~check_in(record);
  for (std::size_t i = record.size() - 5; i > missing + 3; --i) {
    behind = undone(behind, 8) ^ record[i];
  }
  std::uint32_t before = seed(which);
  for (std::size_t i = 0; i < missing; ++i) {
    before = taken_in(before, record[i], 8);
  }
  return undone(behind, 32) ^ before;
}

/// Returns random settings that are possible for the model `which`.
Stored random_settings(const Model& which, std::mt19937& random) {
  const auto below = [&random](std::uint32_t limit) { return static_cast<std::uint32_t>(random() % limit); };
  Settings settings;
  settings.address = static_cast<std::uint8_t>(1 + below(247));
  settings.baud_code = static_cast<std::uint8_t>(3 + below(8));
  settings.format = static_cast<std::uint8_t>(below(4) << 6U);
  settings.protocol = which.speaks_modbus() && below(2) != 0 ? Protocol::ModbusRtu : Protocol::Ascii;
  settings.watchdog_timeout = static_cast<std::uint8_t>(1 + below(255));
  settings.watchdog_enabled = below(2) != 0;
  settings.timeout_status = below(2) != 0;
  std::string name;
  for (std::uint32_t size = 1 + below(which.longest_name); size > 0; --size) {
    name += static_cast<char>(0x20 + below(0x5F));
  }
  settings.name = Name(name);
  settings.power_on_value = static_cast<std::uint16_t>(random() & which.output_mask());
  settings.safe_value = static_cast<std::uint16_t>(random() & which.output_mask());
  return {settings, static_cast<std::uint16_t>(random())};
}

/// Records that differ in up to four adjacent bytes only. Requires that their checks differ, too.
class OfOneKind {
 public:
  OfOneKind(const char* what, std::size_t at) : what_(what), at_(at) {}
  ~OfOneKind() { EXPECT_GT(checks_.size(), 1000U) << what_; }
  OfOneKind(const OfOneKind&) = delete;
  OfOneKind& operator=(const OfOneKind&) = delete;

  void add(const Stored& stored) {
    const Record record = record_of(stored, model("EX9043D-M"));
    Record others(record.begin(), record.begin() + kCheckAt);
    std::fill_n(others.begin() + static_cast<std::ptrdiff_t>(at_), 4, std::uint8_t{0});
    if (checks_.empty()) {
      others_ = others;
    }
    ASSERT_EQ(others, others_) << what_ << ": another byte differs";
    ASSERT_TRUE(checks_.insert(check_in(record)).second) << what_ << ": two have the same check";
  }

 private:
  const char* what_;
  std::size_t at_;
  Record others_;
  std::unordered_set<std::uint32_t> checks_;
};

// --- written records are read back ---

TEST(Record, FitsAPageOfTheMemory) {
  EXPECT_EQ(record_of(factory()).size(), kRecordSize);
  EXPECT_LE(kRecordSize, 32U);
}

TEST(Record, FactorySettingsOfEveryModelAreReadBack) {
  for (const Model& each : kModels) {
    expect_round_trip(each, {Settings::factory(each), 0});
  }
}

TEST(Record, EveryFieldIsReadBack) { expect_round_trip(the_model(), changed_settings()); }

TEST(Record, AnySettingsOfAnyModelAreReadBack) {
  std::mt19937 random(1);
  for (const Model& each : kModels) {
    for (int i = 0; i < 1000; ++i) {
      expect_round_trip(each, random_settings(each, random));
    }
  }
}

TEST(Record, EachFlagIsReadBackAlone) {
  Stored stored = factory();
  stored.settings.watchdog_enabled = true;
  expect_round_trip(the_model(), stored);
  stored.settings.watchdog_enabled = false;
  stored.settings.timeout_status = true;
  expect_round_trip(the_model(), stored);
}

TEST(Record, EverySequenceNumberIsReadBack) {
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
      3,    19,   0xEF, 0xBE,                   // layout, length, sequence
      0xF7, 0x0A, 0xC0, 1,    0x64, 1,   1,     // address to timeout status
      'p',  'u',  'm',  'p',  '~',  '1', 0, 6,  // name
      0x5C, 0x1A, 0xFF, 0x03,                   // power-on value, safe value
      0x9A, 0x39, 0xF6, 0x4E,                   // check
  };
  EXPECT_EQ(record_of(changed_settings()), changed);
  const Record from_the_factory{
      3,    19,   1,    0,                    //
      1,    6,    0,    1,    0xFF, 0, 0,     //
      '9',  '0',  '4',  '2',  'M',  0, 0, 5,  //
      0,    0,    0,    0,                    //
      0x4C, 0x60, 0x29, 0x33,
  };
  EXPECT_EQ(record_of(factory()), from_the_factory);
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

TEST(Record, TwoThatDifferInAnyByteAreNotEqual) {
  const Record record = record_of(changed_settings());
  for (std::size_t bit = 0; bit < kRecordBits; ++bit) {
    EXPECT_FALSE(with_flipped(record, bit) == record) << bit;
  }
}

// --- invalid records ---

// For given other bytes and a given check, only one value of four adjacent bytes matches. The check therefore
// detects every error in four adjacent bytes.
TEST(Record, AnyFourAdjacentBytesAreDeterminedByTheCheckAndTheOtherBytes) {
  std::mt19937 random(3);
  for (const Model& each : kModels) {
    for (int i = 0; i < 1000; ++i) {
      const Record record = record_of(random_settings(each, random), each);
      for (std::size_t missing = 0; missing + 4 <= kCheckAt; ++missing) {
        Record others = record;
        std::fill_n(others.begin() + static_cast<std::ptrdiff_t>(missing), 4, std::uint8_t{0});
        ASSERT_EQ(word_that_must_be_at(missing, others, each), word_at(record, missing));
      }
    }
  }
}

// Tests the property of the previous test with more than 1000 records for each place.
TEST(Record, TwoThatDifferInFourBytesOnlyNeverHaveTheSameCheck) {
  OfOneKind lines("address, baud code, format and protocol", 4);
  OfOneKind watchdogs("watchdog and timeout status", 8);
  OfOneKind beginnings("the name's first characters", 11);
  OfOneKind ends("the name's last characters", 15);
  OfOneKind values("power-on value and safe value", 19);
  OfOneKind sequences("sequence", 0);
  const Stored from = changed_settings();
  for (unsigned i = 0; i < 0x10000; ++i) {
    const auto value = static_cast<std::uint16_t>(i);
    const auto low = static_cast<std::uint8_t>(i);
    const auto character = [i](unsigned shift) { return static_cast<char>(0x30 + (i >> shift & 0x0FU)); };
    Stored stored = from;
    stored.settings.address = low;
    stored.settings.baud_code = static_cast<std::uint8_t>(3 + (i >> 8U & 7U));
    stored.settings.format = static_cast<std::uint8_t>((i >> 11U & 3U) << 6U);
    stored.settings.protocol = (i >> 13U & 1U) != 0 ? Protocol::ModbusRtu : Protocol::Ascii;
    if (i < 1U << 14U) {
      lines.add(stored);
    }
    stored = from;
    stored.settings.watchdog_timeout = low;
    stored.settings.watchdog_enabled = (i >> 8U & 1U) != 0;
    stored.settings.timeout_status = (i >> 9U & 1U) != 0;
    if (i < 1U << 10U) {
      watchdogs.add(stored);
    }
    stored = from;
    stored.settings.name =
        Name(std::string{character(0), character(4), character(8), character(12), '~', '1'});
    beginnings.add(stored);
    stored.settings.name = Name("pump" + std::string{character(0), character(4), character(8)});
    if (i < 1U << 12U) {
      ends.add(stored);
    }
    stored = from;
    stored.settings.power_on_value = value;
    values.add(stored);
    stored.settings.power_on_value = from.settings.power_on_value;
    stored.settings.safe_value = value;
    if (value != from.settings.safe_value) {
      values.add(stored);
    }
    stored = from;
    stored.sequence = value;
    sequences.add(stored);
  }
}

TEST(Record, EverySingleCorruptedByteIsDetected) {
  for (const Stored& stored : {factory(), changed_settings()}) {
    const Record good = record_of(stored);
    for (std::size_t at = 0; at < kRecordSize; ++at) {
      for (unsigned value = 0; value < 256; ++value) {
        Record bad = good;
        bad[at] = static_cast<std::uint8_t>(value);
        EXPECT_EQ(is_good(the_model(), bad), bad == good) << "byte " << at << ", value " << value;
      }
    }
  }
}

TEST(Record, EveryDoubleBitErrorIsDetected) {
  const Record good = record_of(changed_settings());
  for (std::size_t first = 0; first < kRecordBits; ++first) {
    for (std::size_t second = first + 1; second < kRecordBits; ++second) {
      EXPECT_FALSE(is_good(the_model(), with_flipped(with_flipped(good, first), second)))
          << first << " and " << second;
    }
  }
}

TEST(Record, TripleBitErrorsAreDetected) {
  std::mt19937 random(5);
  const Record good = record_of(changed_settings());
  for (int i = 0; i < 100'000; ++i) {
    const std::size_t first = random() % kRecordBits;
    const std::size_t second = (first + 1 + random() % (kRecordBits - 1)) % kRecordBits;
    std::size_t third = random() % kRecordBits;
    while (third == first || third == second) {
      third = random() % kRecordBits;
    }
    const Record bad = with_flipped(with_flipped(with_flipped(good, first), second), third);
    ASSERT_FALSE(is_good(the_model(), bad)) << first << ", " << second << " and " << third;
  }
}

TEST(Record, ATornWriteToBlankMemoryIsNotARecord) {
  const Record good = record_of(changed_settings());
  for (std::size_t written = 0; written < kRecordSize; ++written) {
    EXPECT_FALSE(is_good(the_model(), torn_record(good, written, filled_with(0xFF)))) << written << " bytes";
  }
}

TEST(Record, ATornWriteOverAnotherRecordIsOneOfTheTwoOrInvalid) {
  const Record older = record_of(factory());
  const Record newer = record_of(changed_settings());
  for (std::size_t written = 0; written <= kRecordSize; ++written) {
    const Record torn = torn_record(newer, written, older);
    EXPECT_EQ(is_good(the_model(), torn), torn == older || torn == newer) << written << " bytes";
  }
}

TEST(Record, ATornWriteOverThePreviousRecordIsOneOfTheTwoOrInvalid) {
  Stored stored = changed_settings();
  const Record older = record_of(stored);
  ++stored.sequence;
  stored.settings.safe_value = 0x0001;
  const Record newer = record_of(stored);
  for (std::size_t written = 0; written <= kRecordSize; ++written) {
    const Record torn = torn_record(newer, written, older);
    EXPECT_EQ(is_good(the_model(), torn), torn == older || torn == newer) << written << " bytes";
  }
}

TEST(Record, WithACheckOfZerosIsInvalid) {
  std::mt19937 random(4);
  for (int i = 0; i < 1000; ++i) {
    Record record = record_of(random_settings(the_model(), random));
    std::fill(record.end() - 4, record.end(), std::uint8_t{0});
    EXPECT_FALSE(is_good(the_model(), record));
  }
}

TEST(Record, OfAnotherModelIsInvalid) {
  for (const Model& writer : kModels) {
    const Record record = record_of({Settings::factory(writer), 1}, writer);
    for (const Model& reader : kModels) {
      EXPECT_EQ(is_good(reader, record), &reader == &writer)
          << writer.designation << " read by " << reader.designation;
    }
  }
}

TEST(Record, BlankZeroedAndUniformMemoryIsNoRecord) {
  for (unsigned value = 0; value < 256; ++value) {
    const Record record = filled_with(static_cast<std::uint8_t>(value));
    EXPECT_FALSE(is_good(the_model(), record)) << value;
    EXPECT_FALSE(is_good(the_model(), with_check(the_model(), record))) << value;
  }
}

TEST(Record, WithACorrectCheckButImpossibleSettingsIsInvalid) {
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
                         Bad{"layout", 0, 1},
                         Bad{"layout", 0, 2},
                         Bad{"layout", 0, 0},
                         Bad{"layout", 0, 4}}) {
    Record record = good;
    record[bad.at] = bad.value;
    EXPECT_FALSE(is_good(the_model(), with_check(the_model(), record))) << bad.what;
  }
  EXPECT_TRUE(is_good(the_model(), with_check(the_model(), good)));
}

TEST(Record, WithACorrectCheckButAnEnabledWatchdogAndTimeout0IsInvalid) {
  Record record = record_of(changed_settings());
  record[8] = 0;
  EXPECT_FALSE(is_good(the_model(), with_check(the_model(), record)));
}

// --- longer and shorter records ---

/// Returns a record of firmware that has more or fewer settings.
Record with_length(const Stored& stored, std::size_t length) {
  Record record = record_of(stored);
  Record settings(record.begin() + kSettingsAt, record.begin() + kCheckAt);
  for (std::size_t more = settings.size(); more < length; ++more) {
    settings.push_back(static_cast<std::uint8_t>(0xC1U ^ more));
  }
  settings.resize(length);
  record.resize(kSettingsAt);
  record[kLengthAt] = static_cast<std::uint8_t>(length);
  record.insert(record.end(), settings.begin(), settings.end());
  record.resize(record.size() + 4);
  return with_check(the_model(), record);
}

TEST(Record, HasRoomFor96BytesOfSettingsAndMore) {
  for (std::size_t length = kSettingsSize; length <= 120; ++length) {
    const std::optional<StoredSettings> found = read(the_model(), with_length(changed_settings(), length));
    ASSERT_TRUE(found) << length;
    EXPECT_TRUE(found->settings == changed_settings().settings) << length;
  }
}

TEST(Record, ThatIsLongerThanItsPlaceIsInvalid) {
  for (std::size_t length = 121; length <= 255; ++length) {
    const Record record = with_length(changed_settings(), length);
    EXPECT_EQ(record_size({record.data(), record.size()}), 0U) << length;
    EXPECT_FALSE(is_good(the_model(), record)) << length;
  }
}

TEST(Record, ThatIsIncompleteIsNotRead) {
  const Record record = with_length(changed_settings(), 60);
  for (std::size_t size = kSettingsAt; size < record.size(); ++size) {
    EXPECT_FALSE(read_record(the_model(), {record.data(), size})) << size;
  }
}

TEST(Record, ThatLacksTheLastSettingsHasTheirFactoryValues) {
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

TEST(Record, ThatIsWrittenOverALongerOneKeepsTheUnknownSettings) {
  for (std::size_t length = kSettingsSize; length <= 120; ++length) {
    const Record longer = with_length(factory(), length);
    RecordBytes bytes{};
    std::copy(longer.begin(), longer.end(), bytes.begin());
    write_record(the_model(), changed_settings().settings, changed_settings().sequence, bytes);
    const Record written(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(longer.size()));
    EXPECT_EQ(written, with_length(changed_settings(), length)) << length;
  }
}

TEST(Record, ThatIsWrittenOverAShorterOneIsAWholeOne) {
  const Record shorter = with_length(changed_settings(), 7);
  RecordBytes bytes{};
  std::copy(shorter.begin(), shorter.end(), bytes.begin());
  write_record(the_model(), changed_settings().settings, changed_settings().sequence, bytes);
  EXPECT_TRUE(std::equal(bytes.begin(), bytes.begin() + kRecordSize, record_of(changed_settings()).begin()));
}

// --- the newest of several copies ---

TEST(Edition, OfANewerLayoutIsNewerThanAnyOfAnOlderLayout) {
  constexpr std::uint16_t kSequences[] = {0, 1, 0x7FFF, 0x8000, 0xFFFF};
  for (const std::uint16_t a : kSequences) {
    for (const std::uint16_t b : kSequences) {
      EXPECT_TRUE((Edition{3, a}.is_newer_than({2, b})));
      EXPECT_FALSE((Edition{2, a}.is_newer_than({3, b})));
      EXPECT_TRUE((Edition{2, a}.is_newer_than({1, b})));
      EXPECT_FALSE((Edition{1, a}.is_newer_than({2, b})));
    }
  }
}

TEST(Edition, OfALaterSequenceIsNewerAcrossTheWrap) {
  for (unsigned from = 0; from < 0x10000; from += 0x1FF) {
    const Edition older{3, static_cast<std::uint16_t>(from)};
    for (const unsigned ahead : {1U, 2U, 0x7FFFU}) {
      const Edition newer{3, static_cast<std::uint16_t>(from + ahead)};
      EXPECT_TRUE(newer.is_newer_than(older));
      EXPECT_FALSE(older.is_newer_than(newer));
    }
    EXPECT_FALSE(older.is_newer_than(older));
    const Edition opposite{3, static_cast<std::uint16_t>(from + 0x8000)};
    EXPECT_FALSE(opposite.is_newer_than(older));
    EXPECT_FALSE(older.is_newer_than(opposite));
  }
}

}  // namespace
}  // namespace ex9000
