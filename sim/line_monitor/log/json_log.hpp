// The log for programs: one JSON object (RFC 8259) per line.
#pragma once

#include <string>

#include "sim/line_monitor/log/bus_log.hpp"

namespace ex9000::sim {

/// Members of the object of a frame:
///   time      start of its first start bit, in seconds of the line's time
///   line      name of the line
///   from      name of the station that sent it, or `unknown sender`
///   bytes     in hex, without blanks
///   text      the bytes as text; present if they have the form of a DCON frame
///   meaning   see `meaning`; present if it is known, the station has a name, and there was no collision
///   error     see `errors`, but only `line_error` if the station has no name; present if there is an error
///   collided  whether a byte collided, see BusObserver::byte
/// Members of the object of a note: time, line, note.
class JsonLog final : public BusLog {
 public:
  JsonLog(std::string line, StationNames names, Print print)
      : line_(std::move(line)), names_(std::move(names)), print_(std::move(print)) {}

  void frame(const Frame& frame) override;
  void note(VirtualTime now, const std::string& text) override;

 private:
  std::string line_;
  StationNames names_;
  Print print_;
};

}  // namespace ex9000::sim
