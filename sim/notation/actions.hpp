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
  /// Bytes written to each port so far, with dropped ones; null: the line has no ports.
  std::function<std::uint64_t()> sent = nullptr;
  bool has_serial_port = false;  ///< if true, actions cannot change the line's rate or format
  /// Logs an action that has changed something; may be null.
  std::function<void(const std::string& text)> note = nullptr;
};
using LinesInUse = std::vector<LineInUse>;

/// Carries out `N ACTION` (on module N, from 1 across all lines), `line NAME ACTION`, or `ACTION` on the only
/// line. The result may be empty. NotNow: the action is possible at another time, and has changed nothing.
std::string act(const LinesInUse& lines, const Words& words);

bool only_reads(const std::string& name);

/// `C [xCOUNT]`: a channel, and up to a million pulses (default 1), which take tens of milliseconds.
struct Pulses {
  unsigned channel;
  std::uint32_t count;
};
Pulses parse_pulses(const Words& args);

/// Of all commands of the control socket: the actions, and those of the program.
std::string action_shapes();
std::string action_help();

}  // namespace ex9000::sim
