// The log for programs: one JSON object (RFC 8259) per line.
#pragma once

#include <string>

#include "sim/line_monitor/log/bus_log.hpp"

namespace ex9000::sim {

/// Members of a frame:
///   time      start of its first start bit, in seconds of the line's time
///   line      name of the line
///   from      name of the station that sent it
///   bytes     in hex, without blanks
///   text      present if the bytes are DCON
///   meaning   present if it is known and there was no collision
///   error     collision, wrong rate or format, noise, wrong CRC or checksum; present if there is any
///   collided  whether a byte collided, see BusObserver::byte
/// Members of a note: time, line, note.
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
