// Keeps what was on the lines in a pcapng file, for Wireshark.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/capture/capture_file.hpp"
#include "sim/frame_watch.hpp"

namespace ex9000::sim {

/// The port that all modules are taken to be at; Wireshark's dissector for Modbus RTU has to know it to tell
/// requests from replies: mbrtu.tcp.port.
constexpr std::uint16_t kCapturedModulesPort = 9000;

/// Every line is an interface, every frame a packet: inbound what a master hears, outbound what it sends.
/// What looks like DCON is text, all else Modbus RTU or, too short for that, bytes. What went wrong with a
/// frame is its comment. Of what faults put on a line it is not told whether it asks or answers.
class Capture {
 public:
  /// Opens the file; see CaptureFile for what it throws, here and later.
  explicit Capture(std::string path) : file_(std::move(path)) {}

  /// Before all else: the file holds an empty capture from now on.
  void begin();
  /// With so many modules, which are attached behind the master. `began`: what the wall clock, since
  /// 1970-01-01 00:00:00 UTC, is taken to have shown at the line's time 0. Returns the line's number for
  /// `write`.
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
