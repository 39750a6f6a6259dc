// The file that a capture is written to.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/files_and_ports/files/file_descriptor.hpp"
#include "sim/files_and_ports/files/wait_for_room.hpp"

namespace ex9000::sim {

/// A regular file, a pipe with a reader, or a device. All messages begin with `place` and `path`.
class CaptureFile {
 public:
  /// Creates a missing file; an existing one keeps its content until `begin`. std::runtime_error: another
  /// simulator uses the file, or the pipe has no reader.
  CaptureFile(
      const std::string& path, const std::string& place, GivesUp gives_up = [] { return false; });

  /// Empties a regular file.
  void begin();
  /// Writes to the kernel, without a buffer in the program: written blocks stay even if the program is
  /// killed. Waits while a pipe is full; once `gives_up` is true, drops the rest and all later blocks. Throws
  /// std::runtime_error if a write fails (disk full, pipe closed), and first removes the incomplete block
  /// from a regular file; if that fails too, the message says so.
  void append(const std::vector<std::uint8_t>& block);

 private:
  std::string where_;  ///< place and path, for messages
  GivesUp gives_up_;
  FileDescriptor file_;
  bool regular_ = false;
  bool given_up_ = false;
};

}  // namespace ex9000::sim
