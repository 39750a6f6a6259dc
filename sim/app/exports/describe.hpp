// `ex9000-sim describe`: describes a model in a form for people, programs or another tool.
#pragma once

#include <optional>
#include <string>

namespace ex9000::sim {

/// The arguments of the command line; the initial values are the defaults.
struct DescribeTexts {
  std::string model;
  std::string format = "markdown";
  std::optional<std::string> address;
  std::optional<std::string> tcp;
  std::optional<std::string> modbus_tcp = std::nullopt;
};

/// Returns `markdown|json|...`, for the help text.
std::string describe_formats();

/// Returns the text to print. Without a model, the text describes all models; some formats require a model.
/// Throws std::invalid_argument with a one-line message that names the argument and says how to fix it.
std::string describe(const DescribeTexts& texts);

}  // namespace ex9000::sim
