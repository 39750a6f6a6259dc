// What a command demands of a module's outputs, and of what decides on them: wire.md 4, 6 and 7, written down
// once more.
#pragma once

#include <cstdint>
#include <optional>

namespace ex9000::judges {

/// Outputs, and what they go to by themselves.
struct Values {
  std::uint16_t outputs = 0;   ///< bit n is channel n, as in the next two
  std::uint16_t power_on = 0;  ///< stored for the next reset
  std::uint16_t safe = 0;      ///< stored for a timeout of the host watchdog
  std::uint8_t timeout = 0;    ///< of the host watchdog, in 0.1 s
  bool enabled = false;        ///< the host watchdog
  bool timed_out = false;      ///< the timeout status, which blocks output commands

  friend constexpr bool operator==(const Values& a, const Values& b) {
    return a.outputs == b.outputs && a.power_on == b.power_on && a.safe == b.safe && a.timeout == b.timeout &&
           a.enabled == b.enabled && a.timed_out == b.timed_out;
  }
  friend constexpr bool operator!=(const Values& a, const Values& b) { return !(a == b); }

  /// wire.md 6: what the host watchdog makes of them.
  [[nodiscard]] constexpr Values expired() const {
    Values values = *this;
    values.outputs = safe;
    values.enabled = false;
    values.timed_out = true;
    return values;
  }
};

/// Of a command that is carried out; what is refused demands nothing.
struct Demand {
  std::uint16_t channels = 0;     ///< that are driven; 0: it is no output command
  std::uint16_t levels = 0;       ///< of these, and of no others
  bool of_power_on = false;       ///< Modbus: the power-on value of these channels becomes the same
  bool of_safe = false;           ///< likewise, the safe value
  bool keeps_power_on = false;    ///< `~AA5P`: the outputs become the power-on value
  bool keeps_safe = false;        ///< `~AA5S`
  bool clears_timeout = false;    ///< the timeout status
  bool restarts = false;          ///< the host watchdog, where it is enabled then
  bool stores_something = false;  ///< whatever it is; it may take its time, and may fail
  std::optional<std::uint8_t> timeout{};
  std::optional<bool> enabled{};

  [[nodiscard]] constexpr bool drives() const { return channels != 0; }
  /// Whether values may be others behind it.
  [[nodiscard]] constexpr bool changes_values() const {
    return drives() || keeps_power_on || keeps_safe || clears_timeout || timeout || enabled;
  }
  [[nodiscard]] constexpr std::uint16_t merged(std::uint16_t value) const {
    return static_cast<std::uint16_t>((value & ~channels) | levels);
  }

  /// The values behind it, where it finds these.
  [[nodiscard]] constexpr Values made_of(Values values) const {
    if ((drives() && values.timed_out) || (timeout == 0 && values.enabled) ||
        (enabled == true && !timeout && values.timeout == 0)) {
      return values;  // refused
    }
    values.outputs = merged(values.outputs);
    store(values, values.outputs);
    values.timed_out = values.timed_out && !clears_timeout;
    return values;
  }

  /// Likewise, where the host watchdog has expired while it was being stored: it drives nothing (D6) and
  /// clears nothing (D17). `outputs`: those before that.
  [[nodiscard]] constexpr Values made_behind_a_timeout(Values values, std::uint16_t outputs) const {
    store(values, outputs);
    values.outputs = values.safe;
    return values;
  }

  /// Whether values can be what they are behind it, nothing but a timeout having come since. `outputs`: those
  /// before the latest timeout. `since`: that was since the command came in.
  [[nodiscard]] constexpr bool is_met_by(const Values& values, std::uint16_t outputs, bool since) const {
    const auto are = [this](std::uint16_t value) { return (value & channels) == levels; };
    const auto kept = [&](std::uint16_t value) {
      return value == values.outputs || (since && value == outputs);
    };
    return (are(values.outputs) || (since && values.timed_out)) && (!of_power_on || are(values.power_on)) &&
           (!of_safe || are(values.safe)) && (!keeps_power_on || kept(values.power_on)) &&
           (!keeps_safe || kept(values.safe)) && (!clears_timeout || !values.timed_out || since) &&
           (!timeout || values.timeout == *timeout) &&
           (!enabled || values.enabled == *enabled || (since && !values.enabled));
  }

 private:
  constexpr void store(Values& values, std::uint16_t outputs) const {
    values.power_on = keeps_power_on ? outputs : of_power_on ? merged(values.power_on) : values.power_on;
    values.safe = keeps_safe ? outputs : of_safe ? merged(values.safe) : values.safe;
    values.timeout = timeout.value_or(values.timeout);
    values.enabled = enabled.value_or(values.enabled);
  }
};

}  // namespace ex9000::judges
