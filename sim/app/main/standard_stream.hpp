// Writes to standard output and standard error.
#pragma once

#include <string>

#include "sim/files_and_ports/files/wait_for_room.hpp"

namespace ex9000::sim {

/// Without a buffer: users read a log while it is written. For one thread at a time.
class StandardStream {
 public:
  /// `file`: STDOUT_FILENO or STDERR_FILENO. `name`: for messages.
  StandardStream(
      int file, std::string name, GivesUp gives_up = [] { return false; });

  /// Blocks while the stream accepts nothing, for example a full pipe. false: `gives_up` is true, or the
  /// reader has closed the pipe. Throws std::runtime_error if the write fails otherwise. After false or an
  /// exception, later calls discard their text and return false.
  bool write(const std::string& text);

 private:
  int file_;
  std::string name_;
  GivesUp gives_up_;
  bool ended_ = false;  ///< later calls of `write` discard their text
};

}  // namespace ex9000::sim
