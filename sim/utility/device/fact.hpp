// What a module tells about its state, for `show` and `poll`.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "sim/utility/device/device.hpp"

namespace ex9000::utility {

struct Fact {
  std::string_view name;
  Needs needs;
  bool changes;  ///< often: `poll` shows it
  /// For people. Throws like Device: Absent if the module does not have it in its protocol.
  std::string (*read)(Device& device, const Model& model);
  /// What a person should know about a value; empty: nothing.
  std::string (*warning)(const std::string& value) = nullptr;
};

extern const std::vector<Fact> facts;

}  // namespace ex9000::utility
