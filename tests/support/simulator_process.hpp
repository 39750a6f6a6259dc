// A running ex9000-sim, started as a user starts it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/child_process.hpp"
#include "tests/support/directory.hpp"

namespace ex9000::system {

/// Returns the path of the program under test. The program has sanitizers if this build has them.
std::string simulator_path();
/// Returns the path of the optimised program, as users get it. The preset `host` builds it.
std::string shipped_simulator_path();

class SimulatorProcess {
 public:
  /// Starts the program with `arguments` in a new temporary directory. Returns when the program has printed
  /// its greeting. Throws std::runtime_error if the program ends earlier, or if it prints nothing for 60 s.
  explicit SimulatorProcess(const std::vector<std::string>& arguments,
                            const std::string& program = simulator_path());

  /// Returns the working directory. It contains the link `ex9000.tty` if the arguments contain neither a port
  /// nor a bus file nor `--speed max`.
  [[nodiscard]] const std::string& directory() const { return directory_.path(); }
  [[nodiscard]] std::string tty() const { return directory() + "/ex9000.tty"; }
  /// Returns a TCP port of the simulator. `position` is the position of the port among the ports for TCP and
  /// Modbus TCP in the greeting, from 0.
  [[nodiscard]] std::uint16_t tcp_port(std::size_t position = 0) const;
  [[nodiscard]] int pid() const { return process_.pid(); }

  /// See ChildProcess.
  bool wait_for(const std::string& text, unsigned times = 1) { return process_.wait_for(text, times); }
  [[nodiscard]] const std::string& output() const { return process_.output(); }
  int end(int signal) { return process_.end(signal); }
  int wait() { return process_.wait(); }

 private:
  Directory directory_;
  ChildProcess process_;
};

}  // namespace ex9000::system
