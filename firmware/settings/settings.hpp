// The settings, and a change of some of them. A module keeps its settings without power - wire.md section 8.
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

/// The bits of the data format, field FF of `%AANNTTCCFF` (manuals 1.10). All other bits are 0.
constexpr std::uint8_t kFormatRisingEdge = 0x80;
constexpr std::uint8_t kFormatChecksum = 0x40;
constexpr std::uint8_t kFormatMask = kFormatRisingEdge | kFormatChecksum;

constexpr std::uint8_t kFirstModbusAddress = 1;
constexpr std::uint8_t kLastModbusAddress = 247;
constexpr bool is_modbus_address(unsigned address) {
  return address >= kFirstModbusAddress && address <= kLastModbusAddress;
}

/// Text of at most 7 characters for the module's name. The constructors ignore all further characters. Not
/// every text is a possible name; see `is_possible`.
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
  /// Returns whether the name has 1 to `longest` characters and each of them is from 0x20 to 0x7E.
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

/// The filter time of each input channel in ms; 0: no filter.
class InputFilters {
 public:
  static constexpr std::uint16_t kLongest = 2000;

  [[nodiscard]] constexpr std::uint16_t of(unsigned channel) const { return milliseconds_[channel]; }
  constexpr void set(unsigned channel, std::uint16_t milliseconds) { milliseconds_[channel] = milliseconds; }
  /// Returns whether any channel has a filter.
  [[nodiscard]] bool any() const;
  /// Returns whether no filter time exceeds kLongest, and only channels below `channels` have a filter.
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
constexpr std::uint8_t kFactoryAddress = 1;
constexpr std::uint8_t kFactoryWatchdogTimeout = 0xFF;

/// One member for each stored setting; `As` is the type of a member. See Settings and SettingsChange.
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
};

/// Calls `f` once for each setting, with this setting of all `settings`, in the order of a record
/// (record.hpp). Append new settings. Never remove or move a setting or change its type, because the memories
/// of existing modules contain records in this layout. Never change the factory value of a setting after
/// `safe_value`, because a record may omit such a setting if it has its factory value.
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
}

template <class Value>
using Itself = Value;

struct Settings : SettingsOf<Itself> {
  /// Returns the settings of a new module (wire.md section 2).
  static Settings factory(const Model& model);

  /// Returns whether `model` could have stored these settings: each value is possible, and no value
  /// contradicts another one.
  [[nodiscard]] bool possible_for(const Model& model) const;

  friend bool operator==(const Settings& a, const Settings& b);
  friend bool operator!=(const Settings& a, const Settings& b) { return !(a == b); }
};

/// New values for some of the settings. A command stores all of these values or none.
struct SettingsChange : SettingsOf<std::optional> {
  /// Returns `settings` with this change. Settings without a new value stay the same.
  [[nodiscard]] Settings applied_to(const Settings& settings) const;
};

}  // namespace ex9000
