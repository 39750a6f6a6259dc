// Writes the log of the bus: one line for each frame.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "sim/frames/frame_watch.hpp"

namespace ex9000::sim {

/// The names of the master and of the modules, in the order of the stations. Stations that faults add to the
/// line follow after the modules and have no name.
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
  /// Writes a remark about the line at `now`.
  virtual void note(VirtualTime now, const std::string& text) = 0;
};

/// The log for people: time, direction, bytes, meaning.
class TextLog final : public BusLog {
 public:
  TextLog(StationNames names, Print print) : names_(std::move(names)), print_(std::move(print)) {}

  void frame(const Frame& frame) override;
  void note(VirtualTime now, const std::string& text) override;

 private:
  StationNames names_;
  Print print_;
};

/// The log for programs: one JSON object (RFC 8259) per line.
///
/// Members of a frame:
///   time      start of its first start bit, in seconds of the line's time
///   line      name of the line
///   from      name of the station that sent it
///   bytes     in hex, without blanks
///   text      present if the bytes are DCON
///   meaning   present if it is known and there was no collision
///   error     collisions, noise, wrong CRC or checksum; present if there are any
///   collided  whether another driver was enabled
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
