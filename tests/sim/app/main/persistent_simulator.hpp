// Runs ex9000-sim with a control socket and a master on its line, for tests with EEPROM files.
#pragma once

#include <chrono>
#include <cstddef>
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
    terminal_.type(command + "\r");
    const std::string reply = terminal_.read_line(kHang);
    return reply.substr(0, reply.find('\r'));
  }
  /// Sends a command to the control socket. See ControlClient::ok.
  std::string tell(const std::string& command) { return control_.ok(command); }

  SimulatorProcess& process() { return process_; }
  [[nodiscard]] const std::string& greeting() const { return process_.output(); }

 private:
  static Arguments arguments(Arguments words) {
    words.insert(words.end(), {"--control", "control", "--timing", "instant", "--log"});
    return words;
  }

  SimulatorProcess process_;
  Terminal terminal_;
  ControlClient control_;
};

}  // namespace ex9000::system
