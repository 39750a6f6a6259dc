#include "tests/support/simulator_process.hpp"

#include <stdexcept>

#include "tests/support/in_repository.hpp"

namespace ex9000::system {

namespace {

std::vector<std::string> command_of(const std::vector<std::string>& arguments, const std::string& program) {
  std::vector<std::string> command{program};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return command;
}

}  // namespace

std::string simulator_path() { return in_repository(EX9000_SIMULATOR); }
std::string shipped_simulator_path() { return in_repository("build/host/sim/ex9000-sim"); }

SimulatorProcess::SimulatorProcess(const std::vector<std::string>& arguments, const std::string& program)
    : process_(command_of(arguments, program), directory_.path()) {
  if (!wait_for("press Ctrl-C to end")) {
    throw std::runtime_error("the simulator has ended, or has printed nothing for 60 s: " + output());
  }
}

std::uint16_t SimulatorProcess::tcp_port(std::size_t position) const {
  const std::string lead = "TCP 127.0.0.1:";
  std::size_t found = output().find(lead);
  for (std::size_t i = 0; i < position; ++i) {
    found = output().find(lead, found + lead.size());
  }
  return static_cast<std::uint16_t>(std::stoul(output().substr(found + lead.size(), 5)));
}

}  // namespace ex9000::system
