// Reads the values of options. An error message begins with the option.
#pragma once

#include <optional>
#include <string>

#include "sim/text/fail.hpp"

namespace ex9000::sim {

/// Returns the value of an option, as `parse` reads it.
template <class Parse>
auto of_option(const char* option, const std::string& text, Parse parse) {
  return with_place(std::string(option) + ": ", [&] { return parse(text); });
}

/// Sets `value` if the option is given.
template <class Parse, class Value>
void take_option(const char* option, const std::optional<std::string>& text, Parse parse, Value& value) {
  if (text) {
    value = of_option(option, *text, parse);
  }
}

}  // namespace ex9000::sim
