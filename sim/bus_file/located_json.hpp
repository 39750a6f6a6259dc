// JSON that knows in which line of its file each value stands.
#pragma once

#include <map>
#include <nlohmann/json.hpp>
#include <string>

namespace ex9000::sim {

struct LocatedJson {
  nlohmann::ordered_json value;  ///< as it was written, so that faults are numbered in their order
  /// By the path of a value, such as `lines[0].modules[1].baud`; the whole is "".
  std::map<std::string, unsigned> lines;
};

/// Throws std::invalid_argument, `LINE: what is wrong`, where `text` is no JSON, or an object has a key
/// twice.
LocatedJson parse_located(const std::string& text);

/// How the path of a member, or of an element, goes on from `path`.
std::string member_of(const std::string& path, const std::string& key);
std::string element_of(const std::string& path, std::size_t index);

}  // namespace ex9000::sim
