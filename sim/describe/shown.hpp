// What a model shows to who polls it over Modbus: a choice from its map, with names.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/model/model.hpp"
#include "sim/describe/register_map.hpp"

namespace ex9000::sim {

enum class Role : std::uint8_t {
  Output,   ///< read and written
  Input,    ///< a level or latch, read
  Counter,  ///< counts up, and from its highest value to 0
  Preset,   ///< a stored value of the outputs; read, since to write it drives them
  State,    ///< on or off is as it should be
  Problem,  ///< on is not
  Tenths,   ///< units of 0.1 s, read
  Button,   ///< a coil that does something when 1 is written to it
};

/// One row of the map, or what is a button of it.
struct Shown {
  std::string_view id;  ///< unique in the model, and stable
  Role role = Role::State;
  std::string_view name;
  Table table = Table::Coils;
  unsigned first = 0;  ///< address, as on the line
  unsigned width = 1;
  bool per_channel = false;

  /// `Output 3`, or the name alone where it is of no channel.
  [[nodiscard]] std::string name_of(unsigned index) const;
  /// `outputs_3` likewise; unique in the model.
  [[nodiscard]] std::string key_of(unsigned index) const;
};

/// In the order of the map. A row that two areas hold is there once, as the first of them has it. Left out is
/// what would take the module away from who polls it (address, rate, protocol), what never answers (host OK),
/// and what never changes (the module's code). Empty where the model speaks no Modbus.
std::vector<Shown> shown_by(const Model& model);

}  // namespace ex9000::sim
