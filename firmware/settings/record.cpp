#include "firmware/settings/record.hpp"

namespace ex9000 {

namespace {

constexpr std::uint8_t kLayout = 1;
constexpr std::size_t kCrcAt = 21;
constexpr std::size_t kNameAt = 14;
constexpr std::uint8_t kFlagWatchdogEnabled = 0x01;
constexpr std::uint8_t kFlagTimeoutStatus = 0x02;

/// CRC-32 (IEEE 802.3) bit by bit: it runs once a store, and a torn page must not slip through as it would
/// once in 65536 times with 16 bits.
class Crc32 {
 public:
  void add(std::uint8_t byte) {
    constexpr std::uint32_t kReflectedPolynomial = 0xEDB8'8320U;
    value_ ^= byte;
    for (int bit = 0; bit < 8; ++bit) {
      value_ = (value_ & 1U) != 0 ? (value_ >> 1U) ^ kReflectedPolynomial : value_ >> 1U;
    }
  }
  [[nodiscard]] std::uint32_t value() const { return ~value_; }

 private:
  std::uint32_t value_ = 0xFFFF'FFFFU;
};

std::uint32_t check_of(const Model& model, const Record& record) {
  Crc32 crc;
  for (const char character : model.designation) {
    crc.add(static_cast<std::uint8_t>(character));
  }
  for (std::size_t i = 0; i < kCrcAt; ++i) {
    crc.add(record[i]);
  }
  return crc.value();
}

void put_word(Record& record, std::size_t at, std::uint16_t value) {
  record[at] = static_cast<std::uint8_t>(value);
  record[at + 1] = static_cast<std::uint8_t>(value >> 8U);
}

std::uint16_t get_word(const Record& record, std::size_t at) {
  return static_cast<std::uint16_t>(record[at] | (record[at + 1] << 8U));
}

}  // namespace

Record encode_record(const Model& model, const StoredSettings& stored) {
  const Settings& settings = stored.settings;
  Record record{};
  record[0] = kLayout;
  put_word(record, 1, stored.sequence);
  record[3] = settings.address;
  record[4] = settings.baud_code;
  record[5] = settings.format;
  record[6] = static_cast<std::uint8_t>(settings.protocol);
  record[7] = static_cast<std::uint8_t>((settings.watchdog_enabled ? kFlagWatchdogEnabled : 0U) |
                                        (settings.timeout_status ? kFlagTimeoutStatus : 0U));
  record[8] = settings.watchdog_timeout;
  put_word(record, 9, settings.power_on_value);
  put_word(record, 11, settings.safe_value);
  const Bytes name = settings.name.bytes();
  record[13] = static_cast<std::uint8_t>(name.size);
  for (std::size_t i = 0; i < name.size; ++i) {
    record[kNameAt + i] = name[i];
  }
  const std::uint32_t check = check_of(model, record);
  put_word(record, kCrcAt, static_cast<std::uint16_t>(check));
  put_word(record, kCrcAt + 2, static_cast<std::uint16_t>(check >> 16U));
  return record;
}

std::optional<StoredSettings> decode_record(const Model& model, const Record& record) {
  const std::uint32_t check = get_word(record, kCrcAt) | (std::uint32_t{get_word(record, kCrcAt + 2)} << 16U);
  if (record[0] != kLayout || check != check_of(model, record)) {
    return std::nullopt;
  }
  if (record[6] > static_cast<std::uint8_t>(Protocol::ModbusRtu) || record[13] > kMaxNameLength) {
    return std::nullopt;
  }
  StoredSettings stored;
  stored.sequence = get_word(record, 1);
  Settings& settings = stored.settings;
  settings.address = record[3];
  settings.baud_code = record[4];
  settings.format = record[5];
  settings.protocol = static_cast<Protocol>(record[6]);
  settings.watchdog_enabled = (record[7] & kFlagWatchdogEnabled) != 0;
  settings.timeout_status = (record[7] & kFlagTimeoutStatus) != 0;
  settings.watchdog_timeout = record[8];
  settings.power_on_value = get_word(record, 9);
  settings.safe_value = get_word(record, 11);
  settings.name = Name(Bytes{record.data() + kNameAt, record[13]});
  if (!settings.possible_for(model)) {
    return std::nullopt;
  }
  return stored;
}

bool is_blank(const Record& record) {
  for (const std::uint8_t byte : record) {
    if (byte != 0xFF) {
      return false;
    }
  }
  return true;
}

}  // namespace ex9000
