// Reads the values of options. An error message begins with the option.
#pragma once

#include <optional>
#include <string>

#include "sim/text/fail.hpp"

namespace ex9000::sim {

/// Returns the result of `parse` for `text`, the value of an option. If `parse` throws an exception, the
/// message begins with the option.
template <class Parse>
auto of_option(const char* option, const std::string& text, Parse parse) {
  return with_place(std::string(option) + ": ", [&] { return parse(text); });
}

/// Sets `value` to the parsed `text` if the option is given. Throws like `of_option`.
template <class Parse, class Value>
void take_option(const char* option, const std::optional<std::string>& text, Parse parse, Value& value) {
  if (text) {
    value = of_option(option, *text, parse);
  }
}

}  // namespace ex9000::sim
