// The command line of ex9000-sim.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "sim/module_spec.hpp"
#include "sim/ports/tcp_address.hpp"

namespace ex9000::sim {

struct Arguments {
  std::vector<ModuleSpec> modules;     ///< at least one
  std::optional<std::string> pty;      ///< where to link a pseudo-terminal
  std::optional<TcpAddress> tcp;       ///< where to listen
  std::optional<std::string> serial;   ///< the port to take; then there is no other
  std::optional<std::string> control;  ///< where to make the control socket
  std::optional<std::uint32_t> baud;   ///< of the line, until a master sets one
  bool echo = false;                   ///< the serial port hears what it sends
  bool instant = false;                ///< bytes cost no time
  bool strict_gaps = false;
  bool log = false;
};

/// Exit status where an argument is wrong.
constexpr int kWrongArguments = 2;

/// What the command line comes to: either something to do, or text to print and a status to exit with.
struct Parsed {
  std::optional<Arguments> arguments;
  std::string output;  ///< for standard output
  std::string error;   ///< one line for standard error
  int exit_status = 0;
};

/// `text` with a blank for every newline; arguments may hold them.
std::string one_line(std::string text);

Parsed parse_arguments(int argc, const char* const* argv);

}  // namespace ex9000::sim
