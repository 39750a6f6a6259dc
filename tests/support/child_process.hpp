// Other programs, as a user would start them.
#pragma once

#include <string>
#include <vector>

namespace ex9000::system {

/// A program in the background; ends with this object, by force if need be.
class ChildProcess {
 public:
  enum class Errors { Apart, WithOutput };

  /// The first word is looked up in PATH. Throws std::runtime_error where it cannot be started. What it
  /// prints on standard error goes where this program's goes, or into `output()`.
  ChildProcess(const std::vector<std::string>& command, const std::string& directory,
               Errors errors = Errors::Apart);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  [[nodiscard]] int pid() const { return pid_; }
  /// Reads what it prints until `text` has come, as often as `times` says; false where it ends before.
  bool wait_for(const std::string& text, unsigned times = 1);
  /// All it has printed so far, as far as it was read.
  [[nodiscard]] const std::string& output() const { return output_; }

  /// Sends `signal` and waits for the end; the exit status, or 128 + the signal that ended it.
  int end(int signal);
  /// Waits for the end likewise.
  int wait();

 private:
  bool read_more();

  std::string output_;
  int pid_ = -1;
  int out_ = -1;
};

struct Finished {
  int status;
  std::string output;  ///< standard output
  std::string error;   ///< standard error
};

/// Runs a command to its end; the first word is looked up in PATH.
Finished run(const std::vector<std::string>& command, const std::string& directory = "/");

}  // namespace ex9000::system
