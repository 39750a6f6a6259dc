// What can be read and set in a module, for `show`, `set`, `save` and `restore`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/utility/device/device.hpp"

namespace ex9000::utility {

/// When a new value is in force.
enum class InForce : std::uint8_t {
  Now,
  AtReset,        ///< at the next one
  AtResetModbus,  ///< at the next one, in ASCII now
  AtResetAscii,   ///< at the next one, in Modbus now
};

struct Property {
  std::string_view key;    ///< as in the settings of the simulator, or the id of the register
  std::string_view value;  ///< stands for the value in help
  std::string_view does;   ///< for help
  Needs needs;
  /// The value as `read` writes it. Throws std::invalid_argument if the model cannot have it.
  std::string (*form)(const Model& model, const std::string& value);
  /// Throws like Device: Absent if the module does not have it in its protocol.
  std::string (*read)(Device& device, const Model& model);
  /// `value`: from `form`. Throws like Device.
  void (*write)(Device& device, const Model& model, const std::string& value);
  InForce in_force = InForce::Now;
  std::string_view beware = {};  ///< what a change does besides; empty: nothing
  bool only_in_ascii = false;    ///< a module that speaks Modbus does not take it
};

[[nodiscard]] bool needs_reset(const Property& property, const Device& device);

/// In the order in which they are set: first what a module refuses without INIT*, then the
/// address, last the host watchdog, which could expire meanwhile.
extern const std::vector<Property> properties;

/// Throws std::invalid_argument.
const Property& property_called(const std::string& key);

}  // namespace ex9000::utility
