// Tests the check of a record of settings. The check detects errors in the stored bytes and torn writes
// (wire.md section 8 and D8).
#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <random>
#include <string>
#include <unordered_set>

#include "tests/firmware/settings/record_bench.hpp"

namespace ex9000 {
namespace {

/// Returns the first `written` bytes of `newer`, followed by the rest of `older`.
Record torn_record(const Record& newer, std::size_t written, Record older) {
  std::copy_n(newer.begin(), written, older.begin());
  return older;
}

std::uint32_t word_at(const Record& record, std::size_t at) {
  std::uint32_t word = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    word += std::uint32_t{record[at + i]} << (8 * i);
  }
  return word;
}

std::uint32_t check_in(const Record& record) { return word_at(record, record.size() - 4); }

/// Inverts `taken_in`: returns the exclusive or of the CRC and the data from which `taken_in` computed
/// `result`. The highest bit of `kReflectedPolynomial` is 1, so the highest bit of `result` shows whether the
/// last step applied the polynomial.
std::uint32_t undone(std::uint32_t result, int bits) {
  for (int bit = 0; bit < bits; ++bit) {
    const bool divided = result >> 31U != 0;
    result = divided ? (result ^ kReflectedPolynomial) << 1U | 1U : result << 1U;
  }
  return result;
}

/// Returns the four bytes from `missing` on, low byte first, calculated from the check and the other bytes of
/// the record.
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

/// Collects records that may differ only in the four bytes from `at` on and in their checks. The test fails
/// if another byte differs, if two records have the same check, or if there are no more than 1000 records.
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
    ASSERT_TRUE(checks_.insert(check_in(record)).second) << what_ << ": two records have the same check";
  }

 private:
  const char* what_;
  std::size_t at_;
  Record others_;
  std::unordered_set<std::uint32_t> checks_;
};

// --- what the check determines ---

// Four adjacent bytes before the check have only one possible value if the check and all bytes except these
// four are known. The check therefore detects every error that is limited to four such bytes and does not
// change the length of the record.
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

// The property that the previous test checks implies the property that this test checks. This test compares
// more than 1000 records for each of six groups of adjacent bytes.
TEST(Record, RecordsThatDifferInUpToFourAdjacentBytesHaveDifferentChecks) {
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

// --- errors and torn writes ---

TEST(Record, AnyCorruptionOfASingleByteIsDetected) {
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

TEST(Record, RandomTripleBitErrorsAreDetected) {
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

TEST(Record, ATornWriteToBlankMemoryLeavesNoValidRecord) {
  const Record good = record_of(changed_settings());
  for (std::size_t written = 0; written < kRecordSize; ++written) {
    EXPECT_FALSE(is_good(the_model(), torn_record(good, written, filled_with(0xFF)))) << written << " bytes";
  }
}

TEST(Record, ATornWriteOverAnotherRecordLeavesOneOfTheTwoRecordsOrAnInvalidOne) {
  const Record older = record_of(factory());
  const Record newer = record_of(changed_settings());
  for (std::size_t written = 0; written <= kRecordSize; ++written) {
    const Record torn = torn_record(newer, written, older);
    EXPECT_EQ(is_good(the_model(), torn), torn == older || torn == newer) << written << " bytes";
  }
}

TEST(Record, ATornWriteOverThePreviousRecordLeavesOneOfTheTwoRecordsOrAnInvalidOne) {
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

TEST(Record, ARecordWithACheckOfZerosIsInvalid) {
  std::mt19937 random(4);
  for (int i = 0; i < 1000; ++i) {
    Record record = record_of(random_settings(the_model(), random));
    std::fill(record.end() - 4, record.end(), std::uint8_t{0});
    EXPECT_FALSE(is_good(the_model(), record));
  }
}

}  // namespace
}  // namespace ex9000
