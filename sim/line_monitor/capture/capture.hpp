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

/// Stands for all modules: Wireshark tells requests from replies by it. Set mbrtu.tcp.port to this value.
constexpr std::uint16_t kCapturedModulesPort = 9000;

/// Each line is an interface, and each frame a packet, outbound if the master sends it, with its errors as
/// comment. A frame that looks like DCON, even a damaged one, is marked as text, any other as Modbus RTU or,
/// below five bytes, as data. A frame from a fault is marked neither as request nor as reply.
class Capture {
 public:
  /// See CaptureFile, whose exceptions all functions may throw.
  Capture(
      const std::string& path, const std::string& place, GivesUp gives_up = [] { return false; })
      : file_(path, place, std::move(gives_up)) {}

  /// First: replaces the content of the file with an empty capture.
  void begin();
  /// Its modules are stations 1 to `modules`. `began`: the timestamp of the line's time 0, since 1970-01-01
  /// 00:00:00 UTC. Returns the number for `write`.
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
