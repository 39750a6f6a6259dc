// The log of an RS-485 line: one line of text for each frame and for each note.
#pragma once

#include <functional>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "sim/line_monitor/frames/frame_watch.hpp"

namespace ex9000::sim {

/// In the order of the stations. Stations attached later, for example by faults, have no name.
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

class LineLog {
 public:
  using Print = std::function<void(const std::string& line)>;
  using Note = std::function<void(VirtualTime now, const std::string& text)>;

  LineLog() = default;
  LineLog(const LineLog&) = delete;
  LineLog& operator=(const LineLog&) = delete;
  virtual ~LineLog() = default;

  virtual void frame(const Frame& frame) = 0;
  /// `now`: of the line's clock.
  virtual void note(VirtualTime now, const std::string& text) = 0;
};

/// For people: a frame's time, direction, sender and bytes, its errors, and its meaning if known.
std::unique_ptr<LineLog> text_log(StationNames names, LineLog::Print print);

/// For programs: each entry is a line with one JSON object (RFC 8259). Members for a frame:
///   time      line time in seconds at the start of the first start bit
///   line      name of the line
///   from      name of the station that sent the frame, or `unknown sender`
///   bytes     in hex, without blanks
///   text      the bytes as text; present if they have the form of a DCON frame
///   meaning   see `meaning`; present if it is known, the station has a name, and there was no collision
///   error     see `errors`, but only `line_error` if the station has no name; present if there is an error
///   collided  whether at least one byte collided, see WireObserver::byte
/// Members for a note: time, line, note.
std::unique_ptr<LineLog> json_log(std::string line, StationNames names, LineLog::Print print);

}  // namespace ex9000::sim
