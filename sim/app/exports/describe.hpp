// `ex9000-sim describe`: describes one model or all models, for people, for programs or for another tool.
#pragma once

#include <optional>
#include <string>

namespace ex9000::sim {

/// The arguments of `describe`. If the user omits an argument, its member keeps the initial value.
struct DescribeTexts {
  std::string model;
  std::string format = "markdown";
  std::optional<std::string> address = std::nullopt;
  std::optional<std::string> port = std::nullopt;
};

/// Returns the names of the formats: `csv|esphome|...`.
std::string format_names();

/// Returns one line for each format, for --help: its name, its text, and in parentheses what it requires and
/// which options it has.
std::string format_help();

/// Returns the text to print. Without a model, the text describes all models; some formats require a model.
/// Throws std::invalid_argument with a one-line message that names the argument and says how to fix it.
///
/// Each format is a file NAME.ENDING.template in this folder, where ENDING is that of a file with the text.
/// Its first line is `{{! SCOPE: TEXT }}`. TEXT is for --help, and SCOPE is one of
/// - any: describes one model or all models;
/// - model: describes one model that speaks Modbus;
/// - address: describes such a model at an address. The template also gets `module`, with `name`, `key` and
///   `address`;
/// - port: describes such a module behind a port of the simulator. `module` also has `host`, `port` and
///   `modbus_tcp`.
std::string describe(const DescribeTexts& texts);

}  // namespace ex9000::sim
