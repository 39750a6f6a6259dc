// Interface for code that observes a play, for example to log it.
#pragma once

#include <string>

#include "sim/line/line.hpp"

namespace ex9000::play {

class Onlooker {
 public:
  Onlooker() = default;
  Onlooker(const Onlooker&) = delete;
  Onlooker& operator=(const Onlooker&) = delete;
  virtual ~Onlooker() = default;

  /// Called before each run of a file. `what` names the file and, for a transcript, the model.
  virtual void begins(const std::string& what) = 0;
  /// Called when a line has started up. The line exists until `ends` is called. `name` may be empty if there
  /// is only one line. Returns the receiver of messages about its faults.
  virtual sim::Faults::Notice joins(sim::Line& line, const std::string& name) = 0;
  /// Called when all events on the lines up to `now` have been processed.
  virtual void reached(sim::VirtualTime now) = 0;
  /// Called at the end of each run.
  virtual void ends() = 0;
};

}  // namespace ex9000::play
