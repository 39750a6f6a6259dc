// A module in INIT mode, where all its settings can be read and written (wire.md section 2).
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/settings/settings.hpp"
#include "sim/utility/master_line/master_line.hpp"
#include "sim/utility/verify/rig.hpp"

namespace ex9000::utility {

/// What a module says about itself.
struct Nameplate {
  std::uint8_t address = 0;  ///< the stored one
  std::string name;
  std::string version;
  std::optional<std::uint32_t> serial_number;
  const Model* model = nullptr;  ///< by the name; null: this is not enough
};

/// DCON commands in INIT mode that make the settings `wanted` of `now`. Not for the timeout status if it is
/// wanted, and not for the serial number, for which there is no such command.
std::vector<std::string> commands_between(const Model& model, const Settings& now, const Settings& wanted);

/// All functions but `leave` require INIT mode. They throw NotVerified if the module does not reply, or not
/// as wire.md says; and what Rig and Connection throw.
class InitMode {
 public:
  /// A module starts in this time (wire.md D13).
  static constexpr std::chrono::milliseconds kStart{100};

  InitMode(MasterLine& line, Rig& rig) : line_(line), rig_(rig) {}

  /// Resets the module by its supply into INIT mode or out of it.
  void enter() { restart(true); }
  void leave() { restart(false); }
  /// The supply of the module has been switched.
  [[nodiscard]] bool has_restarted() const { return has_restarted_; }

  Nameplate nameplate();
  /// Settings that the module does not know have factory values. The serial number is that in force, or 0.
  Settings read(const Model& model);
  /// Leaves INIT mode meanwhile if the serial number differs: only a module that speaks Modbus takes one.
  void write(const Model& model, const Settings& wanted);
  /// Each input reads 0.
  bool inputs_are_off(const Model& model);
  /// The shortest time that a reply takes longer than on a line without delay, as far as the module's own
  /// part can be told from that of the port.
  Time latency();

 private:
  void restart(bool init);
  void write_all_but_serial_number(const Model& model, const Settings& wanted);
  void write_serial_number(const Model& model, std::uint32_t wanted);
  std::optional<std::string> exchange(const std::string& command);
  std::optional<std::string> extension(unsigned address);
  /// The reply.
  std::string ask(const std::string& command);

  MasterLine& line_;
  Rig& rig_;
  bool has_restarted_ = false;
  bool watchdog_runs_ = false;
};

}  // namespace ex9000::utility
