// Every way to make a module store something - wire.md section 8 - and what it is to become of the settings.
// None of the core's code takes part in that but its types.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"

namespace ex9000 {

/// INIT* when the command comes.
enum class Init : std::uint8_t {
  Released,
  Tied,       ///< since it has come up: configuration permission
  SinceReset  ///< the module runs in INIT mode
};

struct StoringCommand {
  std::string name;
  Protocol protocol;  ///< that the module has to speak; INIT mode is ASCII whatever is stored
  Init init = Init::Released;
  /// What must be so before it can store anything.
  std::function<void(Settings&)> prepare;
  /// What is sent: ASCII without checksum and CR, Modbus without CRC. Empty: nothing, it is the host watchdog
  /// that stores.
  std::function<std::vector<std::uint8_t>(const Settings&)> frame;
  /// What it does to the settings; `outputs` are those at that moment.
  std::function<void(Settings&, std::uint16_t outputs)> change;
  /// What the outputs are once it is done, where it drives them.
  std::function<std::uint16_t(const Settings& done, std::uint16_t outputs)> drive;
  bool answered = true;  ///< else a broadcast, or no command at all

  [[nodiscard]] bool is_timeout() const { return !frame; }
  /// Whether it changes anything of these, without preparation.
  [[nodiscard]] bool stores_from(const Settings& settings, std::uint16_t outputs) const;
  [[nodiscard]] Settings done_to(Settings settings, std::uint16_t outputs) const {
    change(settings, outputs);
    return settings;
  }
};

/// All of a model that has both protocols.
std::vector<StoringCommand> storing_commands(const Model& model);

/// With CHK where `checksum`, and CR.
std::vector<std::uint8_t> ascii_frame(const std::string& text, bool checksum);

}  // namespace ex9000
