// What a module remembers without power, and how a command changes it - wire.md section 8.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string_view>
#include <type_traits>

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

constexpr std::uint8_t kFactoryAddress = 1;
constexpr std::uint8_t kFactoryWatchdogTimeout = 0xFF;

/// In the order of the record that keeps them (record.hpp), and without gaps.
struct alignas(4) Settings {
  std::uint8_t address = 0;
  std::uint8_t baud_code = 0;
  std::uint8_t format = 0;  ///< FF: kFormatRisingEdge, kFormatChecksum
  Protocol protocol = Protocol::Ascii;
  std::uint8_t watchdog_timeout = 0;  ///< VV, in 0.1 s
  bool watchdog_enabled = false;
  bool timeout_status = false;  ///< the host watchdog has expired and nobody has cleared it
  std::uint8_t unused = 0;
  Name name;
  std::uint16_t power_on_value = 0;  ///< bit n is output channel n
  std::uint16_t safe_value = 0;

  /// Section 2: what a module comes with.
  static constexpr Settings factory(const Model& model) {
    Settings settings;
    settings.address = kFactoryAddress;
    settings.baud_code = kFactoryBaudCode;
    settings.watchdog_timeout = kFactoryWatchdogTimeout;
    settings.protocol = model.speaks_modbus() ? Protocol::ModbusRtu : Protocol::Ascii;
    settings.name = Name(model.factory_name);
    return settings;
  }

  /// Whether this model could ever have stored these.
  [[nodiscard]] bool possible_for(const Model& model) const;

  friend bool operator==(const Settings& a, const Settings& b);
  friend bool operator!=(const Settings& a, const Settings& b) { return !(a == b); }
};

static_assert(sizeof(Settings) == 20 && std::is_trivially_copyable<Settings>::value,
              "they are compared, merged and stored as they lie");

/// Some fields of the settings and their new values: what one command changes, all or nothing.
class SettingsChange {
 public:
  void address(std::uint8_t value) { set(offsetof(Settings, address), value); }
  void baud_code(std::uint8_t value) { set(offsetof(Settings, baud_code), value); }
  void format(std::uint8_t value) { set(offsetof(Settings, format), value); }
  void protocol(Protocol value) { set(offsetof(Settings, protocol), static_cast<std::uint8_t>(value)); }
  void name(const Name& value);
  void power_on_value(std::uint16_t value) { set_word(offsetof(Settings, power_on_value), value); }
  void safe_value(std::uint16_t value) { set_word(offsetof(Settings, safe_value), value); }
  void watchdog_enabled(bool value) { set(offsetof(Settings, watchdog_enabled), value ? 1 : 0); }
  void watchdog_timeout(std::uint8_t value) { set(offsetof(Settings, watchdog_timeout), value); }
  void timeout_status(bool value) { set(offsetof(Settings, timeout_status), value ? 1 : 0); }
  /// It does not name the timeout status any more.
  void keep_timeout_status() { named_.bytes[offsetof(Settings, timeout_status)] = 0; }

  /// It names nothing.
  void clear();
  /// `settings` with this change made; what it does not name stays.
  [[nodiscard]] Settings applied_to(const Settings& settings) const;

 private:
  void set(std::size_t at, std::uint8_t value);
  void set_word(std::size_t at, std::uint16_t value);

  // Byte by byte as the settings lie: FF where one is named, and its new value.
  struct alignas(4) Image {
    std::array<std::uint8_t, sizeof(Settings)> bytes{};
  };
  Image named_;
  Image values_;
};

}  // namespace ex9000
