// Commands that make a module store settings, and timeouts of the host watchdog, which have the same effect
// (wire.md section 8). The command ~AAXRRRRVVVV is not included. The expected settings after each command or
// timeout are calculated without the code of the core, except for its types and constants.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"

namespace ex9000 {

/// The state of INIT* when the command arrives.
enum class Init : std::uint8_t {
  Released,
  Tied,       ///< connected to GND after the reset: configuration permission, but no INIT mode
  SinceReset  ///< connected to GND since the reset, so the module runs in INIT mode
};

struct StoringCommand {
  std::string name;
  Protocol protocol;  ///< the protocol that the module must use; always ASCII in INIT mode
  Init init = Init::Released;
  /// Changes the settings on which the command depends, if there are any. Example: sets the timeout status
  /// for a command that clears it.
  std::function<void(Settings&)> prepare;
  /// Returns the frame to send: ASCII without checksum and CR, or Modbus without CRC. If this function is
  /// empty, the test sends no frame, and the timeout of the host watchdog stores the settings.
  std::function<std::vector<std::uint8_t>(const Settings&)> frame;
  /// Applies the expected change to the settings. `outputs`: the outputs before the command.
  std::function<void(Settings&, std::uint16_t outputs)> change;
  /// Returns the outputs after the command or the timeout. `done`: the settings after it. `outputs`: the
  /// outputs before it. This function is empty if the command never drives outputs.
  std::function<std::uint16_t(const Settings& done, std::uint16_t outputs)> drive;
  bool answered = true;  ///< false for a broadcast and for a timeout of the host watchdog

  [[nodiscard]] bool is_timeout() const { return !frame; }
  /// Returns whether the command changes these settings and requires no preparation for that.
  [[nodiscard]] bool stores_from(const Settings& settings, std::uint16_t outputs) const;
  [[nodiscard]] Settings done_to(Settings settings, std::uint16_t outputs) const {
    change(settings, outputs);
    return settings;
  }
};

/// Returns the commands for `model`, and one timeout of the host watchdog for each protocol. `model` must
/// support both protocols. It must have 16 outputs or none, and at least 8 inputs or none.
std::vector<StoringCommand> storing_commands(const Model& model);

/// Returns `text`, then the checksum of `text` if `checksum` is true, then CR.
std::vector<std::uint8_t> ascii_frame(const std::string& text, bool checksum);

}  // namespace ex9000
