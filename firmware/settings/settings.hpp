// What a module remembers without power, and how a command changes it - wire.md section 8.
#pragma once

#include <array>
#include <cstdint>
#include <string_view>

#include "firmware/bytes.hpp"
#include "firmware/model/baud.hpp"
#include "firmware/model/model.hpp"

namespace ex9000 {

enum class Protocol : std::uint8_t { Ascii = 0, ModbusRtu = 1 };

/// Bits of the data format FF (manuals 1.10); all others are 0.
constexpr std::uint8_t kFormatRisingEdge = 0x80;
constexpr std::uint8_t kFormatChecksum = 0x40;
constexpr std::uint8_t kFormatMask = kFormatRisingEdge | kFormatChecksum;

constexpr std::uint8_t kFirstModbusAddress = 1;
constexpr std::uint8_t kLastModbusAddress = 247;
constexpr bool is_modbus_address(unsigned address) {
  return address >= kFirstModbusAddress && address <= kLastModbusAddress;
}

/// The module's name, 1 to 7 characters 0x20 to 0x7E.
class Name {
 public:
  constexpr Name() = default;
  constexpr explicit Name(std::string_view text) {
    for (const char character : text) {
      append(static_cast<std::uint8_t>(character));
    }
  }
  constexpr explicit Name(Bytes text) {
    for (const std::uint8_t character : text) {
      append(character);
    }
  }

  static constexpr bool is_name_character(std::uint8_t byte) { return byte >= 0x20 && byte <= 0x7E; }

  [[nodiscard]] constexpr Bytes bytes() const { return {characters_.data(), length_}; }

  friend constexpr bool operator==(const Name& a, const Name& b) {
    for (unsigned i = 0; i < kMaxNameLength; ++i) {
      if (a.characters_[i] != b.characters_[i]) {
        return false;
      }
    }
    return a.length_ == b.length_;
  }

 private:
  constexpr void append(std::uint8_t character) {
    if (length_ < kMaxNameLength) {
      characters_[length_++] = character;
    }
  }

  std::array<std::uint8_t, kMaxNameLength> characters_{};
  std::uint8_t length_ = 0;
};

struct Settings {
  std::uint8_t address = 1;
  std::uint8_t baud_code = kFactoryBaudCode;
  std::uint8_t format = 0;  ///< FF: kFormatRisingEdge, kFormatChecksum
  Protocol protocol = Protocol::Ascii;
  Name name;
  std::uint16_t power_on_value = 0;  ///< bit n is output channel n
  std::uint16_t safe_value = 0;
  bool watchdog_enabled = false;
  std::uint8_t watchdog_timeout = 0xFF;  ///< VV, in 0.1 s
  bool timeout_status = false;           ///< the host watchdog has expired and nobody has cleared it

  /// Section 2: what a module comes with.
  static constexpr Settings factory(const Model& model) {
    Settings settings;
    settings.protocol = model.speaks_modbus() ? Protocol::ModbusRtu : Protocol::Ascii;
    settings.name = Name(model.factory_name);
    return settings;
  }

  /// Whether this model could ever have stored these.
  [[nodiscard]] bool possible_for(const Model& model) const;

  friend bool operator==(const Settings& a, const Settings& b);
  friend bool operator!=(const Settings& a, const Settings& b) { return !(a == b); }
};

/// Some fields of the settings and their new values: what one command changes, all or nothing.
class SettingsChange {
 public:
  constexpr SettingsChange& address(std::uint8_t value) { return set(kAddress, values_.address, value); }
  constexpr SettingsChange& baud_code(std::uint8_t value) { return set(kBaudCode, values_.baud_code, value); }
  constexpr SettingsChange& format(std::uint8_t value) { return set(kFormat, values_.format, value); }
  constexpr SettingsChange& protocol(Protocol value) { return set(kProtocol, values_.protocol, value); }
  constexpr SettingsChange& name(const Name& value) { return set(kName, values_.name, value); }
  constexpr SettingsChange& power_on_value(std::uint16_t value) {
    return set(kPowerOnValue, values_.power_on_value, value);
  }
  constexpr SettingsChange& safe_value(std::uint16_t value) {
    return set(kSafeValue, values_.safe_value, value);
  }
  constexpr SettingsChange& watchdog_enabled(bool value) {
    return set(kWatchdogEnabled, values_.watchdog_enabled, value);
  }
  constexpr SettingsChange& watchdog_timeout(std::uint8_t value) {
    return set(kWatchdogTimeout, values_.watchdog_timeout, value);
  }
  constexpr SettingsChange& timeout_status(bool value) {
    return set(kTimeoutStatus, values_.timeout_status, value);
  }

  /// It names nothing.
  [[nodiscard]] constexpr bool empty() const { return fields_ == 0; }
  /// `settings` with this change made; what it does not name stays.
  [[nodiscard]] Settings applied_to(const Settings& settings) const;

 private:
  enum Field : std::uint16_t {
    kAddress = 1U << 0U,
    kBaudCode = 1U << 1U,
    kFormat = 1U << 2U,
    kProtocol = 1U << 3U,
    kName = 1U << 4U,
    kPowerOnValue = 1U << 5U,
    kSafeValue = 1U << 6U,
    kWatchdogEnabled = 1U << 7U,
    kWatchdogTimeout = 1U << 8U,
    kTimeoutStatus = 1U << 9U,
  };

  template <class T>
  constexpr SettingsChange& set(Field field, T& slot, const T& value) {
    slot = value;
    fields_ = static_cast<std::uint16_t>(fields_ | field);
    return *this;
  }

  std::uint16_t fields_ = 0;
  Settings values_;
};

}  // namespace ex9000
