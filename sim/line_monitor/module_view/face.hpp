// The part of a module's state that viewers show: LEDs, switches, and internal state.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "sim/virtual_line/wires/module.hpp"

namespace ex9000::sim {

enum class Led : std::uint8_t {
  Off,
  On,
  HostTimeout,         ///< flashes at 2 Hz
  SettingsUnreadable,  ///< two short flashes every 2 s
};

/// The state that viewers show on the front plate of a module.
struct Plate {
  bool switched_on = false;  ///< the supply's switch
  bool powered = false;      ///< false during a supply failure, even if the switch is on
  bool init = false;         ///< INIT* is tied to GND
  bool listening = false;    ///< the module has started up
  bool init_mode = false;    ///< the module has started up in INIT mode (wire.md section 2)
  // address, mode, protocol and checksum are valid only if `listening`.
  std::uint8_t address = 0;  ///< the address in force
  hal::SerialMode mode;      ///< rate and format in force
  Protocol protocol = Protocol::Ascii;
  bool checksum = false;
  Led led = Led::Off;
  std::uint16_t outputs = 0;  ///< outputs that are on; bit n is channel n
  std::uint16_t inputs = 0;   ///< levels at the terminals; bit n is channel n
  /// The remaining time of each timed output, in units of 0.1 s, rounded up; 0: the timer does not run.
  std::array<std::uint16_t, kMaxOutputs> timers{};
  std::uint64_t watchdog_resets = 0;

  friend bool operator==(const Plate& a, const Plate& b);
};

/// Latches and counters since reset or clearing; valid only while the module listens.
struct InputRecords {
  std::uint16_t latched_high = 0;
  std::uint16_t latched_low = 0;
  std::array<std::uint32_t, kMaxInputs> counters{};

  friend bool operator==(const InputRecords& a, const InputRecords& b);
};

/// The state of the host watchdog, and the reset status; valid only while the module listens.
struct HostWatchdogState {
  bool enabled = false;
  bool timed_out = false;    ///< the timeout status
  std::uint8_t timeout = 0;  ///< in units of 0.1 s
  /// Line time at which the host watchdog expires if no request restarts it; nullopt: it does not run.
  std::optional<VirtualTime> expires;
  bool reset_status = false;  ///< the reset status that `$AA5` would report

  friend bool operator==(const HostWatchdogState& a, const HostWatchdogState& b);
};

/// The content of the memory. It is also valid while the module has no power.
struct Stored {
  struct Copy {
    std::vector<std::uint8_t> bytes;        ///< the whole copy; if it is invalid, the first page of its place
    std::optional<std::uint16_t> sequence;  ///< nullopt: the copy is invalid

    friend bool operator==(const Copy& a, const Copy& b) { return a.bytes == b.bytes; }
  };

  std::vector<Copy> copies;            ///< in the order of hal::kPlaces
  std::optional<std::size_t> current;  ///< index of the copy that a reset would load; nullopt: none is valid
  bool blank = false;                  ///< all copies are blank, so a reset would load factory settings
  Settings settings;                   ///< settings in copy `current`; factory settings if no copy is valid

  friend bool operator==(const Stored& a, const Stored& b);
};

/// The part of a module's state that viewers show. The model is not included, because it does not change.
struct Face {
  Plate plate;
  InputRecords records;
  HostWatchdogState host_watchdog;
  Stored stored;
};

/// Reads the state without changing the line or the module. `now` is the present line time. It may be later
/// than the time of the line's clock, but not earlier.
Face face_of(const SimulatedModule& module, VirtualTime now);

/// Returns `off`, `on`, `flashing`, or `flashing: settings unreadable`.
std::string_view led_text(Led led);
/// Returns the module's name in `settings`.
std::string name_text(const Settings& settings);

}  // namespace ex9000::sim
