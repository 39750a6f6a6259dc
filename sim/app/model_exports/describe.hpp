// `ex9000-sim describe`: describes one model or all models, for people, for programs or for another tool.
#pragma once

#include <optional>
#include <string>

namespace ex9000::sim {

/// The arguments of `describe`. If the user omits an argument, its member keeps the initial value.
struct DescribeTexts {
  std::string model;
  std::string format = "markdown";
  std::optional<std::string> address;
  std::optional<std::string> tcp;
  std::optional<std::string> modbus_tcp = std::nullopt;
};

/// Returns the names of the formats: `markdown|json|...`.
std::string describe_formats();

/// Returns the text to print. Without a model, the text describes all models; some formats require a model.
/// Throws std::invalid_argument with a one-line message that names the argument and says how to fix it.
std::string describe(const DescribeTexts& texts);

}  // namespace ex9000::sim
