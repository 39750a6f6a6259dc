// Tables of the keys of a bus file, with one row for each key. `read_bus` and its error messages use these
// tables. The JSON Schema and the lists of keys in sim/docs/bus-files.md are generated from these tables.
#pragma once

#include <array>
#include <string_view>

#include "sim/app/setup/setup.hpp"
#include "sim/app/setup_from_bus_file/node.hpp"

namespace ex9000::sim {

template <class Object>
struct BusFileKey {
  std::string_view name;
  std::string_view schema;   ///< the JSON Schema of the key's value, as JSON
  std::string_view meaning;  ///< a description for people
  void (*take)(Object& object, const Node& value);
};

/// A module whose keys `read_bus` is reading.
struct ModuleObject {
  ModuleSpec spec;
  LineSetup& line;  ///< the line that the module is on
  Places places;    ///< the place of each key in the file
};

extern const std::array<BusFileKey<Setup>, 7> bus_keys;
extern const std::array<BusFileKey<LineSetup>, 14> line_keys;
extern const std::array<BusFileKey<ModuleObject>, 12> module_keys;

/// Reads all keys of the bus file whose root is `root`. Throws the exceptions of Node.
Setup read_bus(const Node& root);

}  // namespace ex9000::sim
