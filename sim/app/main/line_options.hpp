// Reads the modules and the options of a single RS-485 line from the command line.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "sim/app/setup/setup.hpp"

namespace ex9000::sim {

/// The arguments of a single line as text.
struct LineTexts {
  std::vector<std::string> modules;
  std::vector<std::string> inputs;
  std::vector<std::string> faults;
  std::optional<std::string> pty;
  std::optional<std::string> pty_access;
  std::optional<std::string> tcp;
  std::optional<std::string> modbus_tcp;
  std::optional<std::string> modbus_timeout;
  std::optional<std::string> serial;
  std::optional<std::string> baud;
  std::optional<std::string> format;
  std::optional<std::string> kind;  ///< the value of --line
  bool echo = false;
  bool strict_gaps = false;
};

/// Returns the line that the arguments define. Throws std::invalid_argument with a one-line message.
LineSetup line_of(const LineTexts& texts);

/// Rejects all arguments in `texts` except `bus_file`, because the bus file defines the lines.
/// `texts.modules` must contain `bus_file`. Throws std::invalid_argument with a one-line message.
void reject_line_options(const std::string& bus_file, const LineTexts& texts);

}  // namespace ex9000::sim
