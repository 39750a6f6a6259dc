// `ex9000-sim describe`: describes one model or all models, for people, for programs or for another tool.
#pragma once

#include <optional>
#include <string>

namespace ex9000::sim {

/// An argument that the user omits keeps its initial value.
struct DescribeTexts {
  std::string model;
  std::string format = "markdown";
  std::optional<std::string> address = std::nullopt;
  std::optional<std::string> port = std::nullopt;
};

/// `csv|esphome|...`
std::string format_names();

/// For --help: a line for each format with its text, what it requires and which options it has.
std::string format_help();

/// Without a model, the text describes all models; some formats require a model. Each format is a file
/// NAME.ENDING.template in this folder; ENDING is that of a file with the text. Its first line is `{{! SCOPE:
/// TEXT }}`. TEXT is for --help, and SCOPE is one of
/// - any: one model or all models;
/// - model: one model that speaks Modbus;
/// - address: such a model at an address; the template also gets `module`, with `name`, `key` and `address`;
/// - port: such a module behind a port of the simulator; `module` also has `host`, `port` and `modbus_tcp`.
std::string describe(const DescribeTexts& texts);

}  // namespace ex9000::sim
