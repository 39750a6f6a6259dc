// What can be seen of a module by somebody who looks at it: its lamps, its switches, and what it knows.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "firmware/model/model.hpp"
#include "firmware/settings/places.hpp"
#include "firmware/settings/settings.hpp"
#include "sim/module.hpp"

namespace ex9000::sim {

enum class Led : std::uint8_t {
  Off,
  On,
  HostTimeout,         ///< flashes at 2 Hz
  SettingsUnreadable,  ///< two short flashes every 2 s
};

/// What its front plate shows.
struct Plate {
  bool switched_on = false;  ///< the supply's switch
  bool powered = false;      ///< a supply may fail behind its switch
  bool init = false;         ///< INIT* tied to GND
  bool listening = false;    ///< it has come up
  bool init_mode = false;    ///< it has come up with INIT*
  std::uint8_t address = 0;  ///< in force, as all below: only while it listens
  std::uint32_t baud = 0;
  Protocol protocol = Protocol::Ascii;
  bool checksum = false;
  Led led = Led::Off;
  std::uint16_t outputs = 0;  ///< what is driven; bit n is channel n
  std::uint16_t inputs = 0;   ///< levels at the terminals, likewise
  std::uint64_t watchdog_resets = 0;

  friend bool operator==(const Plate& a, const Plate& b);
};

/// What its inputs have gathered since reset or clearing; only while it listens.
struct Gathered {
  std::uint16_t latched_high = 0;
  std::uint16_t latched_low = 0;
  std::array<std::uint32_t, kMaxInputs> counters{};

  friend bool operator==(const Gathered& a, const Gathered& b);
};

/// Of the host watchdog.
struct Guard {
  bool enabled = false;
  bool timed_out = false;              ///< the timeout status
  std::uint8_t timeout = 0;            ///< in 0.1 s
  std::optional<VirtualTime> expires;  ///< by the line's clock, if no host OK comes; nothing: it does not run
  bool reset_status = false;           ///< what `$AA5` would tell

  friend bool operator==(const Guard& a, const Guard& b);
};

/// What its memory holds, powered or not.
struct Stored {
  struct Copy {
    std::vector<std::uint8_t> bytes;        ///< as many as it takes, or its first page if it is not good
    std::optional<std::uint16_t> sequence;  ///< nothing: it is not good

    friend bool operator==(const Copy& a, const Copy& b) { return a.bytes == b.bytes; }
  };

  std::vector<Copy> copies;            ///< in the order of kPlaces
  std::optional<std::size_t> current;  ///< the copy that counts; nothing: none is good
  bool blank = false;                  ///< nothing has ever been stored: factory settings are in force
  Settings settings;                   ///< those of `current`, or the factory's

  friend bool operator==(const Stored& a, const Stored& b);
};

/// All of it. The model does not change and is not in here.
struct Face {
  Plate plate;
  Gathered gathered;
  Guard guard;
  Stored stored;
};

/// Reads and changes nothing; neither the line nor the module notices. `now` is what the line's clock shows.
Face face_of(const SimulatedModule& module, VirtualTime now);

/// `off`, `on`, `flashing`, and `flashing: settings unreadable`.
std::string_view led_text(Led led);
std::string name_text(const Settings& settings);

}  // namespace ex9000::sim
