// Writes the log of the bus: one line of text for each frame and for each note.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "sim/line_monitor/frames/frame_watch.hpp"

namespace ex9000::sim {

/// The names of the master and of the modules, in the order of the stations. Stations that are attached to
/// the line later, for example by faults, have no name.
class StationNames {
 public:
  explicit StationNames(std::vector<std::string> names) : names_(std::move(names)) {}
  [[nodiscard]] bool know(std::size_t station) const { return station < names_.size(); }
  [[nodiscard]] std::string of(std::size_t station) const {
    return know(station) ? names_[station] : "unknown sender";
  }

 private:
  std::vector<std::string> names_;
};

class BusLog {
 public:
  using Print = std::function<void(const std::string& line)>;
  using Note = std::function<void(VirtualTime now, const std::string& text)>;

  BusLog() = default;
  BusLog(const BusLog&) = delete;
  BusLog& operator=(const BusLog&) = delete;
  virtual ~BusLog() = default;

  virtual void frame(const Frame& frame) = 0;
  /// Writes a note about the line. `now` is the time of the line's clock.
  virtual void note(VirtualTime now, const std::string& text) = 0;
};

}  // namespace ex9000::sim
