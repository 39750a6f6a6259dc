// Writes to standard output and standard error.
#pragma once

#include <string>

#include "sim/files_and_ports/files/wait_for_room.hpp"

namespace ex9000::sim {

/// A standard stream without a buffer, because users read a log while the program writes it. Only one thread
/// at a time may use an object of this class.
class StandardStream {
 public:
  /// `file`: STDOUT_FILENO or STDERR_FILENO. `name`: name of the stream in messages.
  StandardStream(
      int file, std::string name, GivesUp gives_up = [] { return false; });

  /// Writes `text`. If the stream accepts no output, for example because a pipe is full, this function blocks
  /// until the reader reads or closes the pipe, or until `gives_up` returns true. Returns false if `gives_up`
  /// has returned true or the reader has closed the pipe. Throws std::runtime_error with a one-line message
  /// if the write fails for another reason. After an exception or the result false, later calls discard their
  /// text and return false.
  bool write(const std::string& text);

 private:
  int file_;
  std::string name_;
  GivesUp gives_up_;
  bool ended_ = false;  ///< later calls of `write` discard their text
};

}  // namespace ex9000::sim
