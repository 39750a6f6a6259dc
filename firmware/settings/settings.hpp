// The settings, which a module keeps without power, and a change of some of them - wire.md section 8.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>

#include "firmware/bytes.hpp"
#include "firmware/model/baud.hpp"
#include "firmware/model/model.hpp"

namespace ex9000 {

enum class Protocol : std::uint8_t { Ascii = 0, ModbusRtu = 1 };

/// Of the data format, field FF of `%AANNTTCCFF` (manuals 1.10). All other bits are 0.
constexpr std::uint8_t kFormatRisingEdge = 0x80;
constexpr std::uint8_t kFormatChecksum = 0x40;
constexpr std::uint8_t kFormatMask = kFormatRisingEdge | kFormatChecksum;

constexpr std::uint8_t kFirstModbusAddress = 1;
constexpr std::uint8_t kLastModbusAddress = 247;
constexpr bool is_modbus_address(unsigned address) {
  return address >= kFirstModbusAddress && address <= kLastModbusAddress;
}

/// The first 7 characters of a text. Not every one is a possible name.
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
  /// 1 to `longest` characters from 0x20 to 0x7E.
  [[nodiscard]] bool is_possible(unsigned longest) const;

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

/// In ms per input channel; 0: no filter.
class InputFilters {
 public:
  static constexpr std::uint16_t kLongest = 2000;

  [[nodiscard]] constexpr std::uint16_t of(unsigned channel) const { return milliseconds_[channel]; }
  constexpr void set(unsigned channel, std::uint16_t milliseconds) { milliseconds_[channel] = milliseconds; }
  [[nodiscard]] bool any() const;
  /// None above kLongest, none from `channels` on.
  [[nodiscard]] bool are_possible(unsigned channels) const;

  friend constexpr bool operator==(const InputFilters& a, const InputFilters& b) {
    for (unsigned channel = 0; channel < kMaxInputs; ++channel) {
      if (a.of(channel) != b.of(channel)) {
        return false;
      }
    }
    return true;
  }

 private:
  std::array<std::uint16_t, kMaxInputs> milliseconds_{};
};

constexpr std::uint8_t kLongestResponseDelay = 30;  // in ms

/// The high word of every serial number. The numbers of a board or of a user differ in the low word.
constexpr std::uint16_t kSerialNumberFamily = 0x0D00;
constexpr std::uint32_t serial_number_of(std::uint16_t low) {
  constexpr unsigned kBitsOfAWord = 16;
  return std::uint32_t{kSerialNumberFamily} << kBitsOfAWord | low;
}

constexpr std::uint8_t kFactoryAddress = 1;
constexpr std::uint8_t kFactoryWatchdogTimeout = 0xFF;

/// Each stored setting as an `As`: see Settings and SettingsChange.
template <template <class> class As>
struct SettingsOf {
  As<std::uint8_t> address{};
  As<std::uint8_t> baud_code{};         ///< CC (model/baud.hpp)
  As<std::uint8_t> format{};            ///< FF: kFormatRisingEdge, kFormatChecksum
  As<Protocol> protocol{};              ///< from the next reset on
  As<std::uint8_t> watchdog_timeout{};  ///< VV of the host watchdog, in units of 0.1 s
  As<bool> watchdog_enabled{};          ///< the host watchdog is running
  As<bool> timeout_status{};            ///< it has expired, and no command has cleared this status since
  As<Name> name{};
  As<std::uint16_t> power_on_value{};   ///< outputs from reset on; bit n is channel n
  As<std::uint16_t> safe_value{};       ///< outputs instead while the timeout status is set
  As<InputFilters> input_filters{};     ///< register 0x0240 + n
  As<std::uint16_t> inverted_inputs{};  ///< register 0x0250; bit n is input channel n
  As<bool> fed_by_requests{};           ///< register 0x0251: each request restarts the host watchdog
  As<std::uint8_t> response_delay{};    ///< register 0x0252, in ms
  As<std::uint32_t> serial_number{};    ///< registers 0x010E and 0x010F; 0: that of the board
  As<bool> updates_allowed{};           ///< register 0x0254
};

/// Calls `f` for each setting, with it of all `settings`, in the order of a record (record.hpp). Append new
/// ones. Never remove or move a setting or change its type: existing modules have records in this layout.
/// Never change a factory value after `safe_value`: a record may omit such a setting.
template <class F, class... Some>
[[gnu::always_inline]] constexpr void visit(F f, Some&... settings) {
  f(settings.address...);
  f(settings.baud_code...);
  f(settings.format...);
  f(settings.protocol...);
  f(settings.watchdog_timeout...);
  f(settings.watchdog_enabled...);
  f(settings.timeout_status...);
  f(settings.name...);
  f(settings.power_on_value...);
  f(settings.safe_value...);
  f(settings.input_filters...);
  f(settings.inverted_inputs...);
  f(settings.fed_by_requests...);
  f(settings.response_delay...);
  f(settings.serial_number...);
  f(settings.updates_allowed...);
}

template <class Value>
using Itself = Value;

struct Settings : SettingsOf<Itself> {
  /// Of a new module (wire.md section 2).
  static Settings factory(const Model& model);

  /// `model` could have stored these: each value is possible, and none contradicts another.
  [[nodiscard]] bool possible_for(const Model& model) const;

  friend bool operator==(const Settings& a, const Settings& b);
  friend bool operator!=(const Settings& a, const Settings& b) { return !(a == b); }
};

/// New values for some settings; a command stores all of them or none.
struct SettingsChange : SettingsOf<std::optional> {
  [[nodiscard]] Settings applied_to(const Settings& settings) const;
};

}  // namespace ex9000
