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

/// Lists each setting once: SETTING(type, name, factory value, whether `value` is possible). The last two
/// arguments may use `model`, and the last one may use `value`. This list defines the members of Settings and
/// of SettingsChange and the layout of a record (record.hpp), in the same order. Append new settings. Never
/// remove or move a setting or change its type, because the memories of existing modules contain records in
/// this layout. Never change the factory value of a setting after `safe_value`, because a record may omit
/// such a setting if it has its factory value.
///
///     address           the module's address
///     baud_code         CC (model/baud.hpp)
///     format            FF: kFormatRisingEdge, kFormatChecksum
///     protocol          protocol from the next reset on
///     watchdog_timeout  timeout of the host watchdog, VV, in units of 0.1 s
///     watchdog_enabled  the host watchdog is running
///     timeout_status    the host watchdog has expired, and no command has cleared this status since
///     name              the module's name
///     power_on_value    outputs from reset on if the timeout status is clear; bit n is output channel n
///     safe_value        outputs while the timeout status is set
///     input_filters     register 0x0240 + n: filter time of input channel n in ms
///     inverted_inputs   register 0x0250; bit n is input channel n
///     fed_by_requests   register 0x0251: every request for this module restarts the host watchdog
///     response_delay    register 0x0252, in ms
#define EX9000_SETTINGS(SETTING)                                                               \
  SETTING(std::uint8_t, address, kFactoryAddress, true)                                        \
  SETTING(std::uint8_t, baud_code, kFactoryBaudCode, is_baud_code(value))                      \
  SETTING(std::uint8_t, format, 0, (value & ~kFormatMask) == 0)                                \
  SETTING(Protocol, protocol, model.speaks_modbus() ? Protocol::ModbusRtu : Protocol::Ascii,   \
          value == Protocol::Ascii || (value == Protocol::ModbusRtu && model.speaks_modbus())) \
  SETTING(std::uint8_t, watchdog_timeout, kFactoryWatchdogTimeout, true)                       \
  SETTING(bool, watchdog_enabled, false, true)                                                 \
  SETTING(bool, timeout_status, false, true)                                                   \
  SETTING(Name, name, Name(model.factory_name), value.is_possible(model.longest_name))         \
  SETTING(std::uint16_t, power_on_value, 0, (value & ~model.output_mask()) == 0)               \
  SETTING(std::uint16_t, safe_value, 0, (value & ~model.output_mask()) == 0)                   \
  SETTING(InputFilters, input_filters, {}, value.are_possible(model.inputs))                   \
  SETTING(std::uint16_t, inverted_inputs, 0, (value & ~model.input_mask()) == 0)               \
  SETTING(bool, fed_by_requests, false, true)                                                  \
  SETTING(std::uint8_t, response_delay, 0, value <= kLongestResponseDelay)

// NOLINTBEGIN(bugprone-macro-parentheses): the arguments are types and names
struct Settings {
#define EX9000_MEMBER(type, name, factory_value, possible) type name{};
  EX9000_SETTINGS(EX9000_MEMBER)
#undef EX9000_MEMBER

  /// Returns the settings of a new module (wire.md section 2).
  static Settings factory(const Model& model);

  /// Returns whether `model` could have stored these settings: each value is possible, and no value
  /// contradicts another one.
  [[nodiscard]] bool possible_for(const Model& model) const;

  friend bool operator==(const Settings& a, const Settings& b);
  friend bool operator!=(const Settings& a, const Settings& b) { return !(a == b); }
};

/// New values for some of the settings. A command stores all of these values or none.
struct SettingsChange {
#define EX9000_MEMBER(type, name, factory_value, possible) std::optional<type> name{};
  EX9000_SETTINGS(EX9000_MEMBER)
#undef EX9000_MEMBER

  /// Returns `settings` with this change. Settings without a new value stay the same.
  [[nodiscard]] Settings applied_to(const Settings& settings) const;
};
// NOLINTEND(bugprone-macro-parentheses)

}  // namespace ex9000
