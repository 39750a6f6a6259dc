// Settings as they lie in the memory: what is written is read back, and nothing else is taken for settings
// (D8).
#include "firmware/settings/record.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <string>
#include <string_view>
#include <unordered_set>
#include <vector>

namespace ex9000 {
namespace {

const Model& model(std::string_view designation) { return *find_model(designation); }

/// What a record is made of.
struct Stored {
  Settings settings;
  std::uint16_t sequence;
};

/// Every field differs from the factory's.
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

Record record_of(const Stored& stored, const Model& which = the_model()) {
  Record record;
  make_record(which, stored.settings, stored.sequence, record);
  return record;
}

void expect_round_trip(const Model& which, const Stored& stored) {
  const Record record = record_of(stored, which);
  ASSERT_TRUE(is_good(which, record)) << which.designation;
  EXPECT_TRUE(settings_in(record) == stored.settings) << which.designation;
  EXPECT_EQ(sequence_in(record), stored.sequence) << which.designation;
}

Record filled_with(std::uint8_t byte) {
  Record record;
  record.bytes.fill(byte);
  return record;
}

/// The first `written` bytes of `newer`, and behind them `older`.
Record torn_record(const Record& newer, std::size_t written, Record older) {
  std::copy_n(newer.bytes.begin(), written, older.bytes.begin());
  return older;
}

constexpr std::size_t kRecordBits = kRecordSize * 8;

Record with_flipped(Record record, std::size_t bit) {
  record.bytes[bit / 8] = static_cast<std::uint8_t>(record.bytes[bit / 8] ^ (1U << (bit % 8)));
  return record;
}

// --- the check: CRC-32 as IEEE 802.3 has it, a bit at a time, and back ---

constexpr std::size_t kWords = kRecordCheckAt / 4;
using Words = std::array<std::uint32_t, kWords>;

std::uint32_t word_at(const Record& record, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    word += std::uint32_t{record.bytes[at + i]} << (8 * i);
  }
  return word;
}

Words words_in(const Record& record) {
  Words words{};
  for (std::size_t i = 0; i < kWords; ++i) {
    words[i] = word_at(record, 4 * i);
  }
  return words;
}

std::uint32_t check_in(const Record& record) { return word_at(record, kRecordCheckAt); }

constexpr std::uint32_t kReflectedPolynomial = 0xEDB8'8320U;

std::uint32_t taken_in(std::uint32_t crc, std::uint32_t data, int bits) {
  for (; bits > 0; --bits, data >>= 1U) {
    const bool divides = ((crc ^ data) & 1U) != 0;
    crc = divides ? (crc >> 1U) ^ kReflectedPolynomial : crc >> 1U;
  }
  return crc;
}

/// The exclusive or of CRC and word that `taken_in` has made `result` of: the polynomial's highest bit tells
/// whether it was divided by.
std::uint32_t undone(std::uint32_t result) {
  for (int bit = 0; bit < 32; ++bit) {
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

/// So that a test can put in what no module would.
Record with_check(const Model& which, Record record) {
  std::uint32_t crc = seed(which);
  for (const std::uint32_t word : words_in(record)) {
    crc = taken_in(crc, word, 32);
  }
  for (std::size_t i = 0; i < 4; ++i) {
    record.bytes[kRecordCheckAt + i] = static_cast<std::uint8_t>(~crc >> (8 * i));
  }
  return record;
}

/// The only word that can stand at `missing` where a record has this check and these other words.
std::uint32_t word_that_must_be_at(std::size_t missing, const Words& others, std::uint32_t check,
                                   const Model& which) {
  std::uint32_t behind = ~check;
  for (std::size_t i = kWords - 1; i > missing; --i) {
    behind = undone(behind) ^ others[i];
  }
  std::uint32_t before = seed(which);
  for (std::size_t i = 0; i < missing; ++i) {
    before = taken_in(before, others[i], 32);
  }
  return undone(behind) ^ before;
}

/// Any that `which` may have.
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

/// Records that differ in one word only, whose checks are held to differ too.
class OfOneKind {
 public:
  OfOneKind(const char* what, std::size_t word) : what_(what), word_(word) {}
  ~OfOneKind() { EXPECT_GT(checks_.size(), 1000U) << what_; }
  OfOneKind(const OfOneKind&) = delete;
  OfOneKind& operator=(const OfOneKind&) = delete;

  void add(const Stored& stored) {
    const Record record = record_of(stored, model("EX9043D-M"));
    Words words = words_in(record);
    words[word_] = 0;
    if (checks_.empty()) {
      others_ = words;
    }
    ASSERT_EQ(words, others_) << what_ << ": another word differs";
    ASSERT_TRUE(checks_.insert(check_in(record)).second) << what_ << ": two have the same check";
  }

 private:
  const char* what_;
  std::size_t word_;
  Words others_{};
  std::unordered_set<std::uint32_t> checks_;
};

// --- what is written comes back ---

TEST(Record, FitsAPageOfTheMemory) {
  EXPECT_EQ(kRecordSize, 28U);
  EXPECT_EQ(sizeof(Record), kRecordSize);
  EXPECT_LE(sizeof(Record), 32U);
}

TEST(Record, FactorySettingsOfEveryModelComeBack) {
  for (const Model& each : kModels) {
    expect_round_trip(each, {Settings::factory(each), 0});
  }
}

TEST(Record, EveryFieldComesBack) { expect_round_trip(the_model(), changed_settings()); }

TEST(Record, AnySettingsOfAnyModelComeBack) {
  std::mt19937 random(1);
  for (const Model& each : kModels) {
    for (int i = 0; i < 1000; ++i) {
      expect_round_trip(each, random_settings(each, random));
    }
  }
}

TEST(Record, EachFlagComesBackAlone) {
  Stored stored = factory();
  stored.settings.watchdog_enabled = true;
  expect_round_trip(the_model(), stored);
  stored.settings.watchdog_enabled = false;
  stored.settings.timeout_status = true;
  expect_round_trip(the_model(), stored);
}

TEST(Record, EverySequenceNumberComesBack) {
  Stored stored = factory();
  for (unsigned sequence = 0; sequence < 0x10000; sequence += 0xFF) {
    stored.sequence = static_cast<std::uint16_t>(sequence);
    expect_round_trip(the_model(), stored);
  }
}

TEST(Record, TheLongestNameComesBack) {
  Stored stored{Settings::factory(model("EX9068D-M")), 1};
  stored.settings.name = Name("ABCDEFG");
  expect_round_trip(model("EX9068D-M"), stored);
}

// --- the layout ---

TEST(Record, IsLaidOutAsItsHeaderSays) {
  const std::array<std::uint8_t, kRecordSize> changed{
      0xF7, 0x0A, 0xC0, 1,    0x64, 1,   1, 0,  // address to timeout status
      'p',  'u',  'm',  'p',  '~',  '1', 0, 6,  // name
      0x5C, 0x1A, 0xFF, 0x03,                   // power-on value, safe value
      0xEF, 0xBE, 2,    0,                      // sequence, layout
      0x69, 0xAF, 0x7B, 0xA0,                   // check
  };
  EXPECT_EQ(record_of(changed_settings()).bytes, changed);
  const std::array<std::uint8_t, kRecordSize> from_the_factory{
      1,    6,    0,    1,    0xFF, 0, 0, 0,  //
      '9',  '0',  '4',  '2',  'M',  0, 0, 5,  //
      0,    0,    0,    0,                    //
      1,    0,    2,    0,                    //
      0xD2, 0xC5, 0x25, 0x88,
  };
  EXPECT_EQ(record_of(factory()).bytes, from_the_factory);
}

TEST(Record, HasTheCheckThatItsHeaderSays) {
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

// --- what is not a record ---

// The promise of the check, as a proof: whatever the check and the other words are, there is one word only.
TEST(Record, AnyWordFollowsFromTheCheckAndTheOtherWords) {
  std::mt19937 random(3);
  for (const Model& each : kModels) {
    for (int i = 0; i < 1000; ++i) {
      const Record record = record_of(random_settings(each, random), each);
      const Words words = words_in(record);
      for (std::size_t missing = 0; missing < kWords; ++missing) {
        Words others = words;
        others[missing] = 0;
        ASSERT_EQ(word_that_must_be_at(missing, others, check_in(record), each), words[missing]);
      }
    }
  }
}

// And by trial, with tens of thousands of records for each word.
TEST(Record, TwoThatDifferInOneWordOnlyNeverHaveTheSameCheck) {
  OfOneKind lines("address, baud code, format and protocol", 0);
  OfOneKind watchdogs("watchdog and timeout status", 1);
  OfOneKind beginnings("the name's first characters", 2);
  OfOneKind ends("the name's last characters", 3);
  OfOneKind values("power-on value and safe value", 4);
  OfOneKind sequences("sequence", 5);
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

TEST(Record, EverySingleCorruptedByteIsSeen) {
  for (const Stored& stored : {factory(), changed_settings()}) {
    const Record good = record_of(stored);
    for (std::size_t at = 0; at < kRecordSize; ++at) {
      for (unsigned value = 0; value < 256; ++value) {
        Record bad = good;
        bad.bytes[at] = static_cast<std::uint8_t>(value);
        EXPECT_EQ(is_good(the_model(), bad), bad == good) << "byte " << at << ", value " << value;
      }
    }
  }
}

TEST(Record, EveryDoubleBitErrorIsSeen) {
  const Record good = record_of(changed_settings());
  for (std::size_t first = 0; first < kRecordBits; ++first) {
    for (std::size_t second = first + 1; second < kRecordBits; ++second) {
      EXPECT_FALSE(is_good(the_model(), with_flipped(with_flipped(good, first), second)))
          << first << " and " << second;
    }
  }
}

TEST(Record, TripleBitErrorsAreSeen) {
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

TEST(Record, ARecordTornOnBlankMemoryIsNone) {
  const Record good = record_of(changed_settings());
  for (std::size_t written = 0; written < kRecordSize; ++written) {
    EXPECT_FALSE(is_good(the_model(), torn_record(good, written, filled_with(0xFF)))) << written << " bytes";
  }
}

TEST(Record, ARecordTornOnAnotherOneIsEitherOfThemOrNone) {
  const Record older = record_of(factory());
  const Record newer = record_of(changed_settings());
  for (std::size_t written = 0; written <= kRecordSize; ++written) {
    const Record torn = torn_record(newer, written, older);
    EXPECT_EQ(is_good(the_model(), torn), torn == older || torn == newer) << written << " bytes";
  }
}

TEST(Record, ARecordTornOnTheOneBeforeItIsEitherOfThemOrNone) {
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

TEST(Record, OneWhoseCheckWasMadeZerosIsNone) {
  std::mt19937 random(4);
  for (int i = 0; i < 1000; ++i) {
    Record record = record_of(random_settings(the_model(), random));
    std::fill(record.bytes.begin() + kRecordCheckAt, record.bytes.end(), std::uint8_t{0});
    EXPECT_FALSE(is_good(the_model(), record));
  }
}

TEST(Record, AnotherModelsRecordIsNone) {
  for (const Model& writer : kModels) {
    const Record record = record_of({Settings::factory(writer), 1}, writer);
    for (const Model& reader : kModels) {
      EXPECT_EQ(is_good(reader, record), &reader == &writer)
          << writer.designation << " read by " << reader.designation;
    }
  }
}

// 25 bytes with a CRC-32: layout, sequence, address to flags, timeout, values, length and name.
TEST(Record, WhatLayout1StoredIsNone) {
  constexpr std::array<std::uint8_t, 25> kLayout1{1,    0xEF, 0xBE, 0xF7, 0x0A, 0xC0, 1,   3,   0x64,
                                                  0x5C, 0x1A, 0xFF, 0x03, 6,    'p',  'u', 'm', 'p',
                                                  '~',  '1',  0,    0x20, 0xAD, 0x68, 0xCE};
  Record record = filled_with(0xFF);
  std::copy(kLayout1.begin(), kLayout1.end(), record.bytes.begin());
  EXPECT_FALSE(is_good(the_model(), record));
  EXPECT_FALSE(is_blank(record));
}

TEST(Record, BlankZeroedAndUniformMemoryIsNoRecord) {
  for (unsigned value = 0; value < 256; ++value) {
    const Record record = filled_with(static_cast<std::uint8_t>(value));
    EXPECT_FALSE(is_good(the_model(), record)) << value;
    EXPECT_FALSE(is_good(the_model(), with_check(the_model(), record))) << value;
  }
}

TEST(Record, WithARightCheckButWhatTheModelCannotHaveIsNone) {
  struct Bad {
    const char* what;
    std::size_t at;
    std::uint8_t value;
  };
  const Record good = record_of(factory());
  for (const Bad& bad : {Bad{"Modbus address", 0, 0},
                         Bad{"Modbus address", 0, 248},
                         Bad{"baud code", 1, 2},
                         Bad{"baud code", 1, 0x0B},
                         Bad{"format", 2, 0x20},
                         Bad{"protocol", 3, 2},
                         Bad{"protocol", 3, 0xFF},
                         Bad{"watchdog enabled", 5, 2},
                         Bad{"watchdog enabled", 5, 0xFF},
                         Bad{"timeout status", 6, 2},
                         Bad{"timeout status", 6, 0x80},
                         Bad{"name", 8, 0x0D},
                         Bad{"name", 12, 0x7F},
                         Bad{"no name", 15, 0},
                         Bad{"long name", 15, 7},
                         Bad{"longer name", 15, 8},
                         Bad{"longest name", 15, 255},
                         Bad{"power-on value", 17, 0x20},
                         Bad{"safe value", 19, 0x80},
                         Bad{"layout", 22, 1},
                         Bad{"layout", 22, 0},
                         Bad{"layout", 22, 3},
                         Bad{"layout", 23, 1}}) {
    Record record = good;
    record.bytes[bad.at] = bad.value;
    EXPECT_FALSE(is_good(the_model(), with_check(the_model(), record))) << bad.what;
  }
  EXPECT_TRUE(is_good(the_model(), with_check(the_model(), good)));
}

TEST(Record, WithARightCheckButAnArmedWatchdogWithoutTimeoutIsNone) {
  Record record = record_of(changed_settings());
  record.bytes[4] = 0;
  EXPECT_FALSE(is_good(the_model(), with_check(the_model(), record)));
}

TEST(Record, IsBlankWhereAllBytesAreFF) { EXPECT_TRUE(is_blank(filled_with(0xFF))); }

TEST(Record, IsNotBlankWhereAnyByteIsNotFF) {
  for (std::size_t bit = 0; bit < kRecordBits; ++bit) {
    EXPECT_FALSE(is_blank(with_flipped(filled_with(0xFF), bit))) << bit;
  }
  EXPECT_FALSE(is_blank(record_of(factory())));
}

}  // namespace
}  // namespace ex9000
