#include "firmware/settings/record.hpp"

#include "firmware/model/built.hpp"
#include "firmware/words.hpp"

namespace ex9000 {

namespace {

static_assert(__BYTE_ORDER__ == __ORDER_LITTLE_ENDIAN__, "a record is stored as it lies");

constexpr std::uint16_t kLayout = 2;

struct Stored {
  Settings settings;
  std::uint16_t sequence;
  std::uint16_t layout;
};
static_assert(sizeof(Stored) == kRecordCheckAt);

struct Checked {
  Stored stored;
  std::uint32_t check;
};
static_assert(sizeof(Checked) == kRecordSize);

constexpr std::uint32_t mixed(std::uint32_t check, std::uint32_t word) {
  constexpr unsigned kRotation = 13;
  constexpr std::uint32_t kOdd = 0x9E37'79B1;  // 2^32 by the golden ratio: no pattern of bits is a small one
  const std::uint32_t sum = check ^ word;
  return ((sum << kRotation) | (sum >> (32U - kRotation))) * kOdd;
}

constexpr std::uint32_t seed(const Model& model) {
  std::uint32_t check = 0;
  for (const char character : model.designation) {
    check = mixed(check, static_cast<std::uint8_t>(character));
  }
  return check;
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

std::uint32_t check_of(const Model& model, const Stored& stored) {
  std::uint32_t check = seed_of(model);
  for (const std::uint32_t word : words_of(stored)) {
    check = mixed(check, word);
  }
  return check;
}

}  // namespace

bool operator==(const Record& a, const Record& b) { return words_of(a) == words_of(b); }

Record make_record(const Model& model, const Settings& settings, std::uint16_t sequence) {
  Checked checked{{settings, sequence, kLayout}, 0};
  checked.check = check_of(model, checked.stored);
  return object_in<Record>(checked);
}

bool is_good(const Model& model, const Record& record) {
  constexpr std::size_t kEnabledAt = offsetof(Settings, watchdog_enabled);
  constexpr std::size_t kTimeoutAt = offsetof(Settings, timeout_status);
  if ((record.bytes[kEnabledAt] | record.bytes[kTimeoutAt]) > 1) {
    return false;
  }
  const auto checked = object_in<Checked>(record);
  return checked.check == check_of(model, checked.stored) && checked.stored.layout == kLayout &&
         checked.stored.settings.possible_for(model);
}

Settings settings_in(const Record& record) { return object_in<Checked>(record).stored.settings; }
std::uint16_t sequence_in(const Record& record) { return object_in<Checked>(record).stored.sequence; }

bool is_blank(const Record& record) {
  for (const std::uint32_t word : words_of(record)) {
    if (word != 0xFFFF'FFFFU) {
      return false;
    }
  }
  return true;
}

}  // namespace ex9000
