// The effects that a command must have on a module's outputs and on the values that control the outputs:
// an independent implementation of wire.md 4, 6, 7 and 12.
#pragma once

#include <array>
#include <cstdint>
#include <optional>

namespace ex9000::judges {

/// The outputs, and the values that control them.
struct Values {
  std::uint16_t outputs = 0;   ///< bit n is channel n, also in `power_on`, `safe` and `timed`
  std::uint16_t power_on = 0;  ///< stored; the outputs after a reset if the timeout status is clear
  std::uint16_t safe = 0;      ///< stored; the outputs while the timeout status is set
  std::uint8_t timeout = 0;    ///< the timeout of the host watchdog, in units of 0.1 s
  bool enabled = false;        ///< whether the host watchdog is enabled
  bool timed_out = false;      ///< timeout status; while it is set, output commands are refused
  std::uint16_t timed = 0;     ///< the outputs with a running timer

  friend constexpr bool operator==(const Values& a, const Values& b) {
    return a.outputs == b.outputs && a.power_on == b.power_on && a.safe == b.safe && a.timeout == b.timeout &&
           a.enabled == b.enabled && a.timed_out == b.timed_out && a.timed == b.timed;
  }
  friend constexpr bool operator!=(const Values& a, const Values& b) { return !(a == b); }

  /// Returns the values after the host watchdog has expired (wire.md 6).
  [[nodiscard]] constexpr Values expired() const {
    Values values = *this;
    values.outputs = safe;
    values.enabled = false;
    values.timed_out = true;
    values.timed = 0;
    return values;
  }
  /// Returns the values after the timers of `channels` have expired (wire.md 12).
  [[nodiscard]] constexpr Values without_timers(std::uint16_t channels) const {
    Values values = *this;
    values.outputs = static_cast<std::uint16_t>(values.outputs & ~channels);
    values.timed = static_cast<std::uint16_t>(values.timed & ~channels);
    return values;
  }
  /// Returns the outputs that `~AA5V` stores: an output with a running timer is stored as off.
  [[nodiscard]] constexpr std::uint16_t lasting_outputs() const {
    return static_cast<std::uint16_t>(outputs & ~timed);
  }
};

/// The effects that a command has if the module executes it. A refused command has no effects.
struct Demand {
  std::uint16_t channels = 0;  ///< the driven channels; 0: the command drives nothing
  std::uint16_t levels = 0;    ///< the levels of the driven channels
  /// The driven channels whose timer starts. The timers of the other driven channels end.
  std::uint16_t timers = 0;
  std::array<std::uint16_t, 16> units{};  ///< the times of `timers`, in units of 0.1 s
  bool of_power_on = false;               ///< Modbus: the power-on value of `channels` becomes `levels`
  bool of_safe = false;                   ///< Modbus: the safe value of `channels` becomes `levels`
  bool keeps_power_on = false;            ///< `~AA5P`: the outputs are stored as power-on value
  bool keeps_safe = false;                ///< `~AA5S`: the outputs are stored as safe value
  bool clears_timeout = false;            ///< clears the timeout status
  bool restarts = false;                  ///< restarts the host watchdog if it is enabled after the command
  bool stores_something = false;          ///< may store a setting; a store takes time and may fail
  std::optional<std::uint8_t> timeout{};
  std::optional<bool> enabled{};

  [[nodiscard]] constexpr bool drives() const { return channels != 0; }
  /// Returns whether the command can change values.
  [[nodiscard]] constexpr bool changes_values() const {
    return drives() || keeps_power_on || keeps_safe || clears_timeout || timeout || enabled;
  }
  [[nodiscard]] constexpr std::uint16_t merged(std::uint16_t value) const {
    return static_cast<std::uint16_t>((value & ~channels) | levels);
  }

  /// Returns the values after the command, if `values` are those before the command.
  [[nodiscard]] constexpr Values made_of(Values values) const {
    if ((drives() && values.timed_out) || (timeout == 0 && values.enabled) ||
        (enabled == true && !timeout && values.timeout == 0)) {
      return values;  // refused
    }
    values.outputs = merged(values.outputs);
    values.timed = static_cast<std::uint16_t>((values.timed & ~channels) | timers);
    store(values, values.lasting_outputs());
    values.timed_out = values.timed_out && !clears_timeout;
    return values;
  }

  /// Returns the values after the command, if the host watchdog expired while the command was being stored.
  /// After such a command, the outputs have the safe value, which can be new (wire.md D6). The command does
  /// not clear the timeout status (wire.md D17). `values`: those after the timeout. `outputs`: the lasting
  /// outputs before the timeout.
  [[nodiscard]] constexpr Values values_after_a_timeout(Values values, std::uint16_t outputs) const {
    store(values, outputs);
    values.outputs = values.safe;
    return values;
  }

  /// Returns whether `values` are possible after the command, if nothing except a timeout has changed them
  /// since the command. `outputs`: the lasting outputs before the latest timeout. `since`: whether that
  /// timeout occurred after the request was received.
  [[nodiscard]] constexpr bool is_met_by(const Values& values, std::uint16_t outputs, bool since) const {
    const auto are = [this](std::uint16_t value) { return (value & channels) == levels; };
    // A timer that the command starts does not end before the reply, because the shortest time is 0.1 s.
    const bool timers_run = (values.timed & channels) == timers;
    const auto kept = [&](std::uint16_t value) {
      return value == values.lasting_outputs() || (since && value == outputs);
    };
    return ((are(values.outputs) && timers_run) || (since && values.timed_out)) &&
           (!of_power_on || are(values.power_on)) && (!of_safe || are(values.safe)) &&
           (!keeps_power_on || kept(values.power_on)) && (!keeps_safe || kept(values.safe)) &&
           (!clears_timeout || !values.timed_out || since) && (!timeout || values.timeout == *timeout) &&
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
