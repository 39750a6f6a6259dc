// Interface for code that observes how files are played, for example to log the frames.
#pragma once

#include <string>

#include "sim/virtual_line/line/line.hpp"

namespace ex9000::play {

class PlayObserver {
 public:
  PlayObserver() = default;
  PlayObserver(const PlayObserver&) = delete;
  PlayObserver& operator=(const PlayObserver&) = delete;
  virtual ~PlayObserver() = default;

  /// Called before each run of a file. `what` names the file and, for a transcript, the model.
  virtual void run_begins(const std::string& what) = 0;
  /// Called when a line has started up. The line exists until `run_ends` is called. `name` may be empty if
  /// there is only one line. Returns the function that receives the messages about the faults of the line;
  /// the function may be empty.
  virtual sim::Faults::Notice line_started(sim::Line& line, const std::string& name) = 0;
  /// Called when all events on the lines up to `now` have been processed.
  virtual void time_reached(sim::VirtualTime now) = 0;
  /// Called at the end of each run.
  virtual void run_ends() = 0;
};

}  // namespace ex9000::play
