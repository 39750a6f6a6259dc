// What people can do to a running line and its modules: on the control socket, in scenarios and on the panel.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "sim/text/words.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {

struct LineInUse {
  std::string name;  ///< may be empty if there is only one line
  Line& line;
  /// Returns the number of bytes written to each port of the line so far, including dropped bytes; null:
  /// the line has no ports.
  std::function<std::uint64_t()> sent = nullptr;
  bool has_serial_port = false;  ///< if true, actions cannot change the line's rate or format
  /// Logs an action that has changed something; may be null.
  std::function<void(const std::string& text)> note = nullptr;
};
using LinesInUse = std::vector<LineInUse>;

/// Carries out `N ACTION` on module N, counted from 1 across all lines, `line NAME ACTION`, or `ACTION` on
/// the only line. Returns the result; empty if there is none. Throws std::invalid_argument with a one-line
/// message, NotNow if the action is possible at another time, and has changed nothing then.
std::string act(const LinesInUse& lines, const Words& words);

/// Whether this is the name of an action that changes nothing.
bool only_reads(const std::string& name);

/// Parses `C [xCOUNT]`: a channel of the model, and up to a million pulses (default 1), for which the program
/// needs tens of milliseconds.
struct Pulses {
  unsigned channel;
  std::uint32_t count;
};
Pulses parse_pulses(const Words& args);

/// The shapes of all commands of the control socket, for messages: the actions, and those of the program.
std::string action_shapes();
/// The same commands and what they do, for help.
std::string action_help();

}  // namespace ex9000::sim
