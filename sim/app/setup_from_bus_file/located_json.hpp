// A JSON parser that keeps the line number of each value.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace ex9000::sim {

struct LocatedJson {
  nlohmann::ordered_json value;  ///< keeps the order of members, because faults are numbered in that order
  /// Line numbers by the path of a value, for example `lines[0].modules[1].baud`; the path of the whole file
  /// is "". If a key has the form of a path, two values can have the same path. The map then contains only
  /// the line number of the first value.
  std::map<std::string, unsigned> lines;
};

/// Parses `text`. Throws std::invalid_argument with the message `LINE: what is wrong` if `text` is not JSON,
/// a number is too large, an object has the same key twice, a text contains NUL, or there are more than 16
/// levels of arrays and objects.
LocatedJson parse_located(const std::string& text);

/// Returns the path of a member of the object at `path`.
std::string member_of(const std::string& path, const std::string& key);
/// Returns the path of an element of the array at `path`; `index` counts from 0.
std::string element_of(const std::string& path, std::size_t index);

}  // namespace ex9000::sim
