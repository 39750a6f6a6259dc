// Writes the traffic of the lines to a pcapng file, for Wireshark.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "sim/files_and_ports/files/capture_file.hpp"
#include "sim/line_monitor/frames/frame_watch.hpp"

namespace ex9000::sim {

/// The TCP port that represents all modules. Wireshark's dissector for Modbus RTU uses this port to
/// distinguish requests from replies: set mbrtu.tcp.port to this value.
constexpr std::uint16_t kCapturedModulesPort = 9000;

/// Each line becomes an interface, and each frame becomes a packet. The packet is outbound if the master
/// sends the frame, otherwise inbound. A frame that looks like a DCON frame, even a damaged one, is marked as
/// text. All other frames are marked as Modbus RTU or, if they have fewer than five bytes, as data. The
/// errors of a frame become the comment of its packet. A frame that a fault puts on a line is not marked as
/// request or reply.
class Capture {
 public:
  /// Opens the file; see CaptureFile. All functions may throw the exceptions of CaptureFile.
  Capture(
      const std::string& path, const std::string& place, GivesUp gives_up = [] { return false; })
      : file_(path, place, std::move(gives_up)) {}

  /// Replaces the content of the file with an empty capture. Call this first.
  void begin();
  /// Adds a line with `modules` modules, which are stations 1 to `modules`. `began` is the timestamp for time
  /// 0 of the line, since 1970-01-01 00:00:00 UTC. Returns the line's number for `write`.
  std::size_t add_line(const std::string& name, std::size_t modules, std::chrono::nanoseconds began);
  void write(std::size_t line, const Frame& frame);

 private:
  struct CapturedLine {
    std::size_t modules;
    std::chrono::nanoseconds began;
  };

  CaptureFile file_;
  std::vector<CapturedLine> lines_;
};

}  // namespace ex9000::sim
