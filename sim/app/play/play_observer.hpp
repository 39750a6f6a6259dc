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

  /// Before each run. `what`: the file and, for a transcript, the model.
  virtual void run_begins(const std::string& what) = 0;
  /// A line has started up; it exists until `run_ends`. `name` may be empty if there is only one. Returns who
  /// gets the messages about its faults; may be empty.
  virtual sim::Faults::Notice line_started(sim::Line& line, const std::string& name) = 0;
  /// All events on the lines up to `now` have been processed.
  virtual void time_reached(sim::VirtualTime now) = 0;
  virtual void run_ends() = 0;
};

}  // namespace ex9000::play
