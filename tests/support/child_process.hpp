// Starts other programs, as a user does.
#pragma once

#include <string>
#include <vector>

namespace ex9000::system {

/// A program in the background. The destructor kills it if it still runs.
class ChildProcess {
 public:
  enum class Errors { Apart, WithOutput };

  /// Starts the program in the working directory `directory`. The first word of `command` is a path, or the
  /// name of a program in a directory of PATH. Throws std::runtime_error if the program does not start. With
  /// `Apart`, the standard error of the program goes to the standard error of the test. With `WithOutput`,
  /// `output()` includes the standard error of the program.
  ChildProcess(const std::vector<std::string>& command, const std::string& directory,
               Errors errors = Errors::Apart);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  [[nodiscard]] int pid() const { return pid_; }
  /// Reads the output until it contains `text` at least `times` times. Returns false if the program ends
  /// earlier. Kills a program that prints nothing for 60 s, and returns false.
  bool wait_for(const std::string& text, unsigned times = 1);
  /// Returns all output that has been read so far.
  [[nodiscard]] const std::string& output() const { return output_; }

  /// Sends `signal` to the program, then calls `wait`. Returns the result of `wait`.
  int end(int signal);
  /// Waits until the program ends. Kills a program that prints nothing for 60 s. Returns the exit status, or
  /// 128 plus the number of the signal that has ended the program. Call neither `end` nor `wait` again after
  /// one of them has returned.
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

/// Runs a command in the working directory `directory` and waits until it ends. The first word is a path, or
/// the name of a program in a directory of PATH. Kills a command that prints nothing for 60 s and says so in
/// `error`. Throws std::runtime_error if the command does not start.
Finished run(const std::vector<std::string>& command, const std::string& directory = "/");

}  // namespace ex9000::system
