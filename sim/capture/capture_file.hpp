// The file that a capture grows in.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::sim {

/// A regular file, or a pipe that somebody reads.
class CaptureFile {
 public:
  /// Makes it if it is missing; one that is there keeps what it holds until `begin`. Throws
  /// std::invalid_argument, one line, where it cannot be written or another simulator has it.
  explicit CaptureFile(std::string path);
  /// What was made, and never begun, is removed.
  ~CaptureFile();
  CaptureFile(const CaptureFile&) = delete;
  CaptureFile& operator=(const CaptureFile&) = delete;

  /// What it held is gone.
  void begin();
  /// All of it or nothing, and handed to the kernel at once, so that whoever reads it, or kills the program,
  /// finds whole blocks. Blocks where the reader of a pipe does not read. Throws std::runtime_error, one
  /// line, where the disk is full or the reader has gone.
  void append(const std::vector<std::uint8_t>& block);

 private:
  [[noreturn]] void refuse(const std::string& why);

  std::string path_;
  int fd_ = -1;
  bool regular_ = false;
  bool made_ = false;
  bool begun_ = false;
};

}  // namespace ex9000::sim
