// The emulator of an RP2040, in a separate process. Virtual time passes only during a command.
#pragma once

#include <string>

namespace ex9000::pico {

class EmulatorProcess {
 public:
  /// Starts the emulator. Throws std::runtime_error if that fails.
  EmulatorProcess();
  ~EmulatorProcess();
  EmulatorProcess(const EmulatorProcess&) = delete;
  EmulatorProcess& operator=(const EmulatorProcess&) = delete;

  /// Executes a command of emulator.js and returns its result. Throws std::runtime_error with the reason if
  /// the command fails, or if no reply arrives. For example, a command fails if the image does something
  /// that is an error on a real chip.
  std::string execute(const std::string& command);

 private:
  std::string read_line();

  int pid_ = -1;
  int socket_ = -1;
  std::string unread_;
};

}  // namespace ex9000::pico
