// Runs ex9000-sim with a control socket and a master on its line, for tests with EEPROM files.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/support/control_client.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/hang.hpp"
#include "tests/support/simulator_process.hpp"
#include "tests/support/terminal.hpp"

namespace ex9000::system {

using Arguments = std::vector<std::string>;

inline constexpr std::size_t kImageSize = 8192;

inline bool has(const std::string& text, const std::string& part) {
  return text.find(part) != std::string::npos;
}

inline std::string image_in(const Directory& directory) { return ",eeprom=" + directory / "image"; }

/// The program with a control socket, and a master on its line.
class Simulator {
 public:
  explicit Simulator(const Arguments& modules)
      : process_(arguments(modules)),
        terminal_(process_.tty(), 9600),
        control_(process_.directory() + "/control") {}

  /// Sends `command` and a CR on the line. Returns the reply without its CR.
  std::string ask(const std::string& command) {
    type(command);
    const std::string reply = terminal_.read_line(kHang);
    return reply.substr(0, reply.find('\r'));
  }
  /// Sends a command to the control socket. See ControlClient::ok.
  std::string tell(const std::string& command) { return control_.ok(command); }

  /// Sends `command` and a CR on the line. Returns whether a complete reply arrives in one read within
  /// `time`.
  bool is_acknowledged_within(std::chrono::microseconds time, const std::string& command) {
    type(command);
    const std::vector<std::uint8_t> reply = terminal_.read(time);
    return !reply.empty() && reply.back() == '\r';
  }

  /// Switches the supply of module 1 off. First waits until the log contains all commands that this class has
  /// sent on the line, because a command on the control socket could overtake them.
  void power_off() {
    EXPECT_TRUE(process_.wait_for("  > master  ", typed_));
    tell("1 power off");
  }
  /// Calls `power_off`, switches the supply on again, and waits until the module has started.
  void power_cycle() {
    power_off();
    tell("1 power on");
    while (has(tell("1 status"), "mode=starting")) {
    }
    // Discards the replies that the module sent before the power failed.
    while (terminal_.received() < std::stoull(tell("sent")) && !terminal_.read(kHang).empty()) {
    }
  }

  SimulatorProcess& process() { return process_; }
  [[nodiscard]] const std::string& greeting() const { return process_.output(); }

 private:
  static Arguments arguments(Arguments words) {
    words.insert(words.end(), {"--control", "control", "--line", "instant", "--log"});
    return words;
  }

  void type(const std::string& command) {
    terminal_.type(command + "\r");
    ++typed_;
  }

  SimulatorProcess process_;
  Terminal terminal_;
  ControlClient control_;
  unsigned typed_ = 0;
};

}  // namespace ex9000::system
