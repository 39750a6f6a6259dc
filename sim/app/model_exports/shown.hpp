// The values and buttons that exports for Modbus clients show: a selection from a model's map, with names.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/model/model.hpp"
#include "sim/app/model_exports/register_map.hpp"

namespace ex9000::sim {

/// How exports for Modbus clients present an item. These exports write only items with the roles Output and
/// Button. They do not write the other items, even if masters can write them. The Home Assistant export also
/// contains comments with actions for the host watchdog. If the user calls these actions, they write other
/// items.
enum class Role : std::uint8_t {
  Output,   ///< read and written
  Input,    ///< a level or a latch
  Counter,  ///< counts up; after its highest value, it continues with 0
  Preset,   ///< a stored value of the outputs; not written, because a write also drives the outputs
  State,    ///< on or off, both are normal
  Problem,  ///< on means a problem
  Tenths,   ///< units of 0.1 s
  Button,   ///< a coil that starts an action when 1 is written to it
};

/// One row of the map, or a button for a row.
struct Shown {
  std::string_view id;  ///< unique in the model; must not change
  Role role = Role::State;
  std::string_view name;
  Table table = Table::Coils;
  unsigned first = 0;  ///< protocol address
  unsigned width = 1;
  bool per_channel = false;

  /// Returns the name with the channel, for example `Output 3`, or only the name if the row has no channels.
  [[nodiscard]] std::string name_of(unsigned index) const;
  /// Returns the id with the channel, for example `outputs_3`, or only the id if the row has no channels. The
  /// result contains `_` in place of `-`, and is unique in the model.
  [[nodiscard]] std::string key_of(unsigned index) const;
  /// Returns the id with `_` in place of `-`.
  [[nodiscard]] std::string key() const;
};

/// Returns the rows and buttons in the order of the map; empty if the model does not support Modbus. A row
/// that is in two areas appears only in the first of them. The result excludes host OK, the module's code,
/// the counting edge, the coils that repeat the inputs, the extension registers, and the settings whose
/// change would disconnect the client after a reset (address, baud rate and protocol).
std::vector<Shown> shown_by(const Model& model);

/// Returns an id of the model that consists of lower-case letters, digits and `_`, for example `ex9042d_m`.
std::string model_key(const Model& model);

}  // namespace ex9000::sim
