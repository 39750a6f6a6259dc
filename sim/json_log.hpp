// The log for machines: a JSON object (RFC 8259) a line.
#pragma once

#include <string>

#include "sim/bus_log.hpp"

namespace ex9000::sim {

/// Of a frame:
///   time      of its first start bit, seconds of the line's time
///   line      what the line is called
///   from      what the station is called that has sent it
///   bytes     in hex, without blanks
///   text      where they are DCON
///   meaning   where one can tell, and nothing collided
///   error     collisions, noise, wrong CRC or checksum; where there are any
///   collided  whether another driver was on
/// Of a note: time, line, note.
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
