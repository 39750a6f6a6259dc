// Where the user has given a value.
#pragma once

#include <functional>
#include <map>
#include <string>
#include <string_view>

namespace ex9000::sim {

/// The place of each given setting, as the start of a message: `--baud: ` or `bus.yaml:2: baud: `.
using Places = std::map<std::string, std::string, std::less<>>;

inline void prefix_places(Places& places, const std::string& where) {
  for (auto& [name, place] : places) {
    place.insert(0, where);
  }
}

/// Of a setting that is not given: the option that would give it.
inline std::string place_of(const Places& places, std::string_view name) {
  const auto place = places.find(name);
  return place == places.end() ? "--" + std::string(name) + ": " : place->second;
}

}  // namespace ex9000::sim
