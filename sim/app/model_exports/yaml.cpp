#include "sim/app/model_exports/yaml.hpp"

#include <algorithm>
#include <array>
#include <boost/algorithm/string/predicate.hpp>
#include <string_view>

namespace ex9000::sim {

namespace {

using Json = nlohmann::ordered_json;

constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ";
/// Words that YAML 1.1 reads as true, false or null, in upper or lower case.
constexpr std::array kReserved{"true", "false", "yes", "no", "on", "off", "y", "n", "null"};

/// Returns whether the string is simple enough to be written without quotes. Other strings are written in
/// quotes as in JSON, which YAML accepts.
bool is_plain(const std::string& text) {
  return !text.empty() && kLetters.find(text.front()) != std::string_view::npos && text.back() != ' ' &&
         text.find_first_not_of(std::string(kLetters) + "0123456789_ -") == std::string::npos &&
         std::none_of(kReserved.begin(), kReserved.end(),
                      [&](const char* word) { return boost::iequals(text, word); });
}

std::string scalar(const Json& value) {
  return value.is_string() && is_plain(value.get<std::string>()) ? value.get<std::string>() : value.dump();
}

bool is_block(const Json& value) { return value.is_structured() && !value.empty(); }

/// Returns the lines of a value with this indentation. A scalar is one line.
std::string lines_of(const Json& value, const std::string& indent) {
  if (!is_block(value)) {
    return indent + scalar(value) + "\n";
  }
  const std::string deeper = indent + "  ";
  std::string lines;
  for (const auto& [key, item] : value.items()) {
    const std::string below = lines_of(item, deeper);
    // Text that follows `- ` or a key on the same line has no indentation.
    if (value.is_array()) {
      lines += indent + "- " + below.substr(deeper.size());
    } else {
      lines += indent + key + ":" + (is_block(item) ? "\n" + below : " " + below.substr(deeper.size()));
    }
  }
  return lines;
}

}  // namespace

std::string yaml_of(const Json& value) { return lines_of(value, ""); }

}  // namespace ex9000::sim
