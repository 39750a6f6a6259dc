// The file that a capture is written to.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/files_and_ports/files/file_descriptor.hpp"
#include "sim/files_and_ports/files/wait_for_room.hpp"

namespace ex9000::sim {

/// A regular file, a pipe with a reader, or a device.
class CaptureFile {
 public:
  /// Creates the file if it is missing. An existing file keeps its content until `begin`. Throws
  /// std::invalid_argument with a one-line message if the file is not writable, and std::runtime_error if it
  /// is a regular file that another simulator uses, or a pipe without a reader. All messages begin with
  /// `place` and `path`.
  CaptureFile(
      const std::string& path, const std::string& place, GivesUp gives_up = [] { return false; });

  /// Deletes the content of a regular file. Throws std::runtime_error with a one-line message if this fails.
  void begin();
  /// Writes the block to the kernel, without a buffer in the program: blocks that were written stay in the
  /// file even if the program is killed. While a pipe is full, waits until the pipe has room or `gives_up`
  /// returns true. In the second case, discards the rest of this block and all later blocks. Throws
  /// std::runtime_error with a one-line message if a write fails, for example because the disk is full or the
  /// reader has closed the pipe. If a write to a regular file fails, first removes the incomplete block. If
  /// the removal fails too, the message says so.
  void append(const std::vector<std::uint8_t>& block);

 private:
  std::string where_;  ///< place and path, for messages
  GivesUp gives_up_;
  FileDescriptor file_;
  bool regular_ = false;
  bool given_up_ = false;
};

}  // namespace ex9000::sim
