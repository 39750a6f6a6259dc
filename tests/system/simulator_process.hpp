// A running ex9000-sim, as a user would start it.
#pragma once

#include <string>
#include <vector>

namespace ex9000::system {

class SimulatorProcess {
 public:
  /// Starts the program with `arguments` in a fresh directory of its own and returns when it has said on
  /// which pseudo-terminal it is, or has ended.
  explicit SimulatorProcess(const std::vector<std::string>& arguments);
  /// Ends it, by force if need be.
  ~SimulatorProcess();
  SimulatorProcess(const SimulatorProcess&) = delete;
  SimulatorProcess& operator=(const SimulatorProcess&) = delete;

  /// Where it runs; the link `ex9000.tty` is there unless the arguments say otherwise.
  [[nodiscard]] const std::string& directory() const { return directory_; }
  [[nodiscard]] std::string tty() const { return directory_ + "/ex9000.tty"; }
  [[nodiscard]] int pid() const { return pid_; }

  /// Reads what it prints until `text` has come; false where it ends before.
  bool wait_for(const std::string& text);
  /// All it has printed so far, as far as it was read.
  [[nodiscard]] const std::string& output() const { return output_; }

  /// Sends `signal` and waits for the end; the exit status, or 128 + the signal that ended it.
  int end(int signal);
  /// Waits for the end likewise.
  int wait();

 private:
  bool read_more();

  std::string directory_;
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

/// The program under test.
std::string simulator_path();

}  // namespace ex9000::system
