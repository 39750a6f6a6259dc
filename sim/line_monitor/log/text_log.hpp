// The log for people: a line for each frame, with its time, direction, sender, bytes, errors and meaning, and
// a line for each note.
#pragma once

#include <string>

#include "sim/line_monitor/log/bus_log.hpp"

namespace ex9000::sim {

class TextLog final : public BusLog {
 public:
  TextLog(StationNames names, Print print) : names_(std::move(names)), print_(std::move(print)) {}

  void frame(const Frame& frame) override;
  void note(VirtualTime now, const std::string& text) override;

 private:
  StationNames names_;
  Print print_;
};

}  // namespace ex9000::sim
