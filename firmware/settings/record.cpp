#include "firmware/settings/record.hpp"

#include "firmware/settings/crc32.hpp"

namespace ex9000 {

namespace {

constexpr std::size_t kLayoutAt = 0;
constexpr std::size_t kLengthAt = 1;
constexpr std::size_t kSequenceAt = 2;
constexpr std::size_t kSettingsAt = kHeaderSize;
constexpr std::size_t kCheckSize = 4;
constexpr std::size_t kRoomForSettings = kRecordRoom - kSettingsAt - kCheckSize;

constexpr std::size_t known_settings_size() {
  std::size_t size = 0;
  const Settings settings;
  visit([&size](const auto& setting) { size += sizeof setting; }, settings);
  return size;
}
constexpr std::size_t kKnownSettings = known_settings_size();
/// From `address` to `safe_value`, in bytes: this firmware writes these settings into every record.
constexpr std::size_t kFirstSettings = 19;
static_assert(sizeof(bool) == 1 && sizeof(Protocol) == 1 && sizeof(Name) == kMaxNameLength + 1 &&
                  sizeof(InputFilters) == std::size_t{2} * kMaxInputs,
              "the size of a type differs from its size in a record");
static_assert(kKnownSettings <= kRoomForSettings, "the settings do not fit in a record");

class Encoder {
 public:
  explicit Encoder(std::uint8_t* to) : to_(to) {}

  void put(std::uint8_t value) { *to_++ = value; }
  void put(bool value) { put(static_cast<std::uint8_t>(value ? 1 : 0)); }
  void put(Protocol value) { put(static_cast<std::uint8_t>(value)); }
  void put(std::uint16_t value) {
    constexpr unsigned kBitsAByte = 8;
    put(static_cast<std::uint8_t>(value));
    put(static_cast<std::uint8_t>(value >> kBitsAByte));
  }
  void put(std::uint32_t value) {
    constexpr unsigned kBitsAHalf = 16;
    put(static_cast<std::uint16_t>(value));
    put(static_cast<std::uint16_t>(value >> kBitsAHalf));
  }
  void put(const InputFilters& filters) {
    for (unsigned channel = 0; channel < kMaxInputs; ++channel) {
      put(filters.of(channel));
    }
  }
  void put(const Name& name) {
    const Bytes characters = name.bytes();
    for (std::size_t i = 0; i < kMaxNameLength; ++i) {
      put(i < characters.size ? characters.data[i] : std::uint8_t{0});
    }
    put(static_cast<std::uint8_t>(characters.size));
  }

 private:
  std::uint8_t* to_;
};

/// Reads settings one after the other. Those that the record lacks or cuts off keep their values.
class Decoder {
 public:
  explicit Decoder(Bytes from) : from_(from) {}

  template <class Value>
  void take(Value& value) {
    if (from_.size < sizeof value) {
      from_.size = 0;
      return;
    }
    decode(value);
    from_.data += sizeof value;
    from_.size -= sizeof value;
  }
  /// False if a flag or the protocol had a value that its type does not allow.
  [[nodiscard]] bool valid() const { return valid_; }

 private:
  void decode(std::uint8_t& value) { value = from_.data[0]; }
  void decode(bool& value) {
    value = from_.data[0] != 0;
    require(from_.data[0] <= 1);
  }
  void decode(Protocol& value) {
    value = static_cast<Protocol>(from_.data[0]);
    require(value <= Protocol::ModbusRtu);
  }
  void decode(std::uint16_t& value) { value = from_.low_byte_first_16(0); }
  void decode(std::uint32_t& value) { value = from_.low_byte_first_32(0); }
  void decode(InputFilters& value) {
    for (unsigned channel = 0; channel < kMaxInputs; ++channel) {
      value.set(channel, from_.low_byte_first_16(std::size_t{2} * channel));
    }
  }
  void decode(Name& value) {
    // A name that is too long becomes empty, which no model could have stored.
    const std::size_t length = from_.data[kMaxNameLength];
    value = Name(Bytes{from_.data, length <= kMaxNameLength ? length : 0});
  }
  void require(bool valid) {
    if (!valid) {
      valid_ = false;
    }
  }

  Bytes from_;
  bool valid_ = true;
};

/// Bytes of settings up to the last one that differs from its factory value, at least kFirstSettings: with
/// factory values after `safe_value`, a record takes one page.
std::size_t required_size(const Model& model, const Settings& settings) {
  const Settings factory = Settings::factory(model);
  std::size_t size = 0;
  std::size_t required = kFirstSettings;
  const auto measure = [&](const auto& setting, const auto& of_factory) {
    size += sizeof setting;
    if (size > required && !(setting == of_factory)) {
      required = size;
    }
  };
  visit(measure, settings, factory);
  return required;
}

std::uint32_t check_of(const Model& model, Bytes bytes) {
  Crc32 crc;
  for (const char character : model.designation) {
    crc.add(static_cast<std::uint8_t>(character));
  }
  for (const std::uint8_t byte : bytes) {
    crc.add(byte);
  }
  return crc.value();
}

}  // namespace

void write_record(const Model& model, const Settings& settings, std::uint16_t sequence, RecordBytes& record) {
  if (record[kLengthAt] <= kKnownSettings) {  // otherwise the record ends with settings of newer firmware
    record[kLayoutAt] = kLayout;
    record[kLengthAt] = static_cast<std::uint8_t>(required_size(model, settings));
  }
  Encoder(&record[kSequenceAt]).put(sequence);
  Encoder encoder(&record[kSettingsAt]);
  visit([&encoder](const auto& setting) { encoder.put(setting); }, settings);
  const std::size_t check_at = kSettingsAt + record[kLengthAt];
  Encoder(&record[check_at]).put(check_of(model, {record.data(), check_at}));
}

std::size_t record_size(Bytes beginning) {
  const std::size_t length = beginning[kLengthAt];
  const bool begins = beginning[kLayoutAt] == kLayout && length <= kRoomForSettings;
  return begins ? kSettingsAt + length + kCheckSize : 0;
}

std::uint16_t sequence_of(Bytes beginning) { return beginning.low_byte_first_16(kSequenceAt); }

std::optional<StoredSettings> read_record(const Model& model, Bytes record) {
  const std::size_t size = record_size(record);
  if (size == 0 || size > record.size) {
    return std::nullopt;
  }
  const Bytes checked = record.first(size - kCheckSize);
  if (record.low_byte_first_32(checked.size) != check_of(model, checked)) {
    return std::nullopt;
  }
  StoredSettings stored{Settings::factory(model), sequence_of(record)};
  Decoder decoder(checked.from(kSettingsAt));
  visit([&decoder](auto& setting) { decoder.take(setting); }, stored.settings);
  const bool good = decoder.valid() && stored.settings.possible_for(model);
  return good ? std::optional(stored) : std::nullopt;
}

}  // namespace ex9000
