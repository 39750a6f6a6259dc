#include "firmware/settings/record.hpp"

#include <cstddef>

#include "firmware/model/built.hpp"
#include "firmware/words.hpp"

namespace ex9000 {

namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "settings are stored as they lie");

constexpr std::size_t kSettingsWords = kWordsOf<Settings>;
constexpr std::size_t kSequenceAt = sizeof(Settings);
constexpr std::size_t kCheckedWords = kRecordCheckAt / 4;
static_assert(kSequenceAt == 20 && kRecordCheckAt == 24, "as the header says");

constexpr std::uint32_t kLayout = 2;

/// Bit by bit: it is taken where settings are loaded or stored, which takes milliseconds.
constexpr std::uint32_t crc32(std::uint32_t crc, std::uint32_t data, unsigned bits) {
  constexpr std::uint32_t kReflectedPolynomial = 0xEDB8'8320;
  crc ^= data;
  for (; bits != 0; --bits) {
    crc = (crc & 1U) != 0 ? (crc >> 1U) ^ kReflectedPolynomial : crc >> 1U;
  }
  return crc;
}

constexpr std::uint32_t seed(const Model& model) {
  std::uint32_t crc = 0xFFFF'FFFF;
  for (const char character : model.designation) {
    crc = crc32(crc, static_cast<std::uint8_t>(character), 8);
  }
  return crc;
}

std::uint32_t seed_of(const Model& model) {
#ifdef EX9000_MODEL
  static_cast<void>(model);
  constexpr std::uint32_t kSeed = seed(kOnlyModel);
  return kSeed;
#else
  return seed(model);
#endif
}

std::uint32_t check_of(const Model& model, const Record& record) {
  std::uint32_t crc = seed_of(model);
  const Word* word = words_of(record);
  for (std::size_t i = 0; i < kCheckedWords; ++i) {
    crc = crc32(crc, *word++, 32);
  }
  return ~crc;
}

}  // namespace

bool operator==(const Record& a, const Record& b) {
  return same_words(words_of(a), words_of(b), kWordsOf<Record>);
}

void make_record(const Model& model, const Settings& settings, std::uint16_t sequence, Record& record) {
  fill_record(settings, sequence, record);
  seal_record(model, record);
}

void fill_record(const Settings& settings, std::uint16_t sequence, Record& record) {
  reinterpret_cast<Settings&>(record) = settings;
  words_of(record)[kSettingsWords] = sequence | (kLayout << 16U);
}

void seal_record(const Model& model, Record& record) {
  words_of(record)[kCheckedWords] = check_of(model, record);
}

bool is_good(const Model& model, const Record& record) {
  const Word* words = words_of(record);
  if (words[kCheckedWords] != check_of(model, record) || words[kSettingsWords] >> 16U != kLayout ||
      (record.bytes[offsetof(Settings, watchdog_enabled)] |
       record.bytes[offsetof(Settings, timeout_status)]) > 1) {
    return false;
  }
  return settings_in(record).possible_for(model);
}

const Settings& settings_in(const Record& record) { return *reinterpret_cast<const Settings*>(&record); }

std::uint16_t sequence_in(const Record& record) {
  return static_cast<std::uint16_t>(words_of(record)[kSettingsWords]);
}

bool is_blank(const Record& record) {
  const Word* word = words_of(record);
  for (std::size_t i = 0; i < kWordsOf<Record>; ++i) {
    if (*word++ != 0xFFFF'FFFFU) {
      return false;
    }
  }
  return true;
}

}  // namespace ex9000
