// Settings as they lie in the memory: what is written is read back, and nothing else is taken for settings
// (D8).
#include "firmware/settings/record.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string_view>
#include <vector>

namespace ex9000 {
namespace {

const Model& model(std::string_view designation) { return *find_model(designation); }

/// Every field differs from the factory's.
StoredSettings changed_settings() {
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

StoredSettings factory() { return {Settings::factory(the_model()), 1}; }

void expect_round_trip(const Model& which, const StoredSettings& stored) {
  const auto decoded = decode_record(which, encode_record(which, stored));
  ASSERT_TRUE(decoded) << which.designation;
  EXPECT_TRUE(decoded->settings == stored.settings) << which.designation;
  EXPECT_EQ(decoded->sequence, stored.sequence) << which.designation;
}

/// The CRC-32 of the record's layout, so that a test can put in what no encoder would.
Record with_check(const Model& which, Record record) {
  constexpr std::size_t kCheckAt = 21;
  std::uint32_t crc = 0xFFFF'FFFFU;
  const auto add = [&crc](unsigned byte) {
    crc ^= byte;
    for (int bit = 0; bit < 8; ++bit) {
      crc = (crc & 1U) != 0 ? (crc >> 1U) ^ 0xEDB8'8320U : crc >> 1U;
    }
  };
  for (const char character : which.designation) {
    add(static_cast<unsigned char>(character));
  }
  std::for_each(record.begin(), record.begin() + kCheckAt, add);
  for (unsigned i = 0; i < 4; ++i) {
    record[kCheckAt + i] = static_cast<std::uint8_t>(~crc >> (8 * i));
  }
  return record;
}

TEST(Record, FitsAPageOfTheMemory) { EXPECT_LE(sizeof(Record), 32U); }

TEST(Record, FactorySettingsOfEveryModelComeBack) {
  for (const Model& each : kModels) {
    expect_round_trip(each, {Settings::factory(each), 0});
  }
}

TEST(Record, EveryFieldComesBack) { expect_round_trip(the_model(), changed_settings()); }

TEST(Record, EachFlagComesBackAlone) {
  StoredSettings stored = factory();
  stored.settings.watchdog_enabled = true;
  expect_round_trip(the_model(), stored);
  stored.settings.watchdog_enabled = false;
  stored.settings.timeout_status = true;
  expect_round_trip(the_model(), stored);
}

TEST(Record, EverySequenceNumberComesBack) {
  StoredSettings stored = factory();
  for (unsigned sequence = 0; sequence < 0x10000; sequence += 0xFF) {
    stored.sequence = static_cast<std::uint16_t>(sequence);
    expect_round_trip(the_model(), stored);
  }
}

TEST(Record, TheLongestNameComesBack) {
  StoredSettings stored{Settings::factory(model("EX9068D-M")), 1};
  stored.settings.name = Name("ABCDEFG");
  expect_round_trip(model("EX9068D-M"), stored);
}

TEST(Record, IsLaidOutAsItsHeaderSays) {
  const Record record = encode_record(the_model(), changed_settings());
  const std::vector<std::uint8_t> expected{1,    0xEF, 0xBE, 0xF7, 0x0A, 0xC0, 1,   3,   0x64, 0x5C, 0x1A,
                                           0xFF, 0x03, 6,    'p',  'u',  'm',  'p', '~', '1',  0};
  EXPECT_TRUE(std::equal(expected.begin(), expected.end(), record.begin()));
  EXPECT_EQ(record, with_check(the_model(), record));
}

TEST(Record, EverySingleCorruptedByteIsSeen) {
  for (const StoredSettings& stored : {factory(), changed_settings()}) {
    const Record good = encode_record(the_model(), stored);
    for (std::size_t at = 0; at < good.size(); ++at) {
      for (unsigned value = 0; value < 256; ++value) {
        Record bad = good;
        bad[at] = static_cast<std::uint8_t>(value);
        EXPECT_EQ(decode_record(the_model(), bad).has_value(), bad == good)
            << "byte " << at << ", value " << value;
      }
    }
  }
}

TEST(Record, EveryDoubleBitErrorIsSeen) {
  const Record good = encode_record(the_model(), changed_settings());
  const auto flip = [](Record& record, std::size_t bit) {
    record[bit / 8] = static_cast<std::uint8_t>(record[bit / 8] ^ (1U << (bit % 8)));
  };
  for (std::size_t first = 0; first < good.size() * 8; ++first) {
    for (std::size_t second = first + 1; second < good.size() * 8; ++second) {
      Record bad = good;
      flip(bad, first);
      flip(bad, second);
      EXPECT_FALSE(decode_record(the_model(), bad)) << first << " and " << second;
    }
  }
}

TEST(Record, ARecordTornOnBlankMemoryIsNone) {
  const Record good = encode_record(the_model(), changed_settings());
  for (std::size_t written = 0; written < good.size(); ++written) {
    Record torn;
    torn.fill(0xFF);
    std::copy_n(good.begin(), written, torn.begin());
    EXPECT_FALSE(decode_record(the_model(), torn)) << written << " bytes";
  }
}

TEST(Record, ARecordTornOnAnotherOneIsEitherOfThemOrNone) {
  const Record older = encode_record(the_model(), factory());
  const Record newer = encode_record(the_model(), changed_settings());
  for (std::size_t written = 0; written <= newer.size(); ++written) {
    Record torn = older;
    std::copy_n(newer.begin(), written, torn.begin());
    EXPECT_EQ(decode_record(the_model(), torn).has_value(), torn == older || torn == newer)
        << written << " bytes";
  }
}

TEST(Record, ARecordTornOnTheOneBeforeItIsEitherOfThemOrNone) {
  StoredSettings stored = changed_settings();
  const Record older = encode_record(the_model(), stored);
  ++stored.sequence;
  stored.settings.safe_value = 0x0001;
  const Record newer = encode_record(the_model(), stored);
  for (std::size_t written = 0; written <= newer.size(); ++written) {
    Record torn = older;
    std::copy_n(newer.begin(), written, torn.begin());
    EXPECT_EQ(decode_record(the_model(), torn).has_value(), torn == older || torn == newer)
        << written << " bytes";
  }
}

TEST(Record, AnotherModelsRecordIsNone) {
  for (const Model& writer : kModels) {
    const Record record = encode_record(writer, {Settings::factory(writer), 1});
    for (const Model& reader : kModels) {
      EXPECT_EQ(decode_record(reader, record).has_value(), &reader == &writer)
          << writer.designation << " read by " << reader.designation;
    }
  }
}

TEST(Record, BlankZeroedAndUniformMemoryIsNoRecord) {
  for (unsigned value = 0; value < 256; ++value) {
    Record record;
    record.fill(static_cast<std::uint8_t>(value));
    EXPECT_FALSE(decode_record(the_model(), record)) << value;
  }
}

TEST(Record, WithARightCheckButWhatTheModelCannotHaveIsNone) {
  struct Bad {
    const char* what;
    std::size_t at;
    std::uint8_t value;
  };
  const Record good = encode_record(the_model(), factory());
  for (const Bad& bad :
       {Bad{"layout", 0, 2}, Bad{"layout", 0, 0}, Bad{"Modbus address", 3, 0}, Bad{"Modbus address", 3, 248},
        Bad{"baud code", 4, 2}, Bad{"baud code", 4, 0x0B}, Bad{"format", 5, 0x20}, Bad{"protocol", 6, 2},
        Bad{"protocol", 6, 0xFF}, Bad{"power-on value", 10, 0x20}, Bad{"safe value", 12, 0x80},
        Bad{"no name", 13, 0}, Bad{"long name", 13, 7}, Bad{"longer name", 13, 255}, Bad{"name", 14, 0x0D}}) {
    Record record = good;
    record[bad.at] = bad.value;
    EXPECT_FALSE(decode_record(the_model(), with_check(the_model(), record))) << bad.what;
  }
  EXPECT_TRUE(decode_record(the_model(), with_check(the_model(), good)));
}

TEST(Record, WithARightCheckButAnArmedWatchdogWithoutTimeoutIsNone) {
  Record record = encode_record(the_model(), changed_settings());
  record[8] = 0;
  EXPECT_FALSE(decode_record(the_model(), with_check(the_model(), record)));
}

TEST(Record, IsBlankWhereAllBytesAreFF) {
  Record record;
  record.fill(0xFF);
  EXPECT_TRUE(is_blank(record));
}

TEST(Record, IsNotBlankWhereAnyByteIsNotFF) {
  for (std::size_t at = 0; at < kRecordSize; ++at) {
    for (unsigned bit = 0; bit < 8; ++bit) {
      Record record;
      record.fill(0xFF);
      record[at] = static_cast<std::uint8_t>(0xFFU ^ (1U << bit));
      EXPECT_FALSE(is_blank(record)) << "byte " << at;
    }
  }
  EXPECT_FALSE(is_blank(encode_record(the_model(), factory())));
}

}  // namespace
}  // namespace ex9000
