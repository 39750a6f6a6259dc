// `ex9000-sim describe`: what a model has, in a form for people, programs or another tool.
#pragma once

#include <optional>
#include <string>

namespace ex9000::sim {

/// As on the command line; what is not given there is empty, or nothing.
struct DescribeTexts {
  std::string model;
  std::string format = "markdown";
  std::optional<std::string> address;
  std::optional<std::string> tcp;
};

/// `markdown|json|...`, for help.
std::string describe_formats();

/// What is to be printed, of all models where none is named. Throws std::invalid_argument, one line that
/// names the argument and the mend.
std::string describe(const DescribeTexts& texts);

}  // namespace ex9000::sim
