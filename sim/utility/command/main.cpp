// ex9000: works with real and simulated modules on a line.
#include <unistd.h>

#include <csignal>
#include <iostream>
#include <optional>

#include "sim/utility/command/program.hpp"

namespace {

/// Ctrl-C ends the reading: its signal interrupts it, as the library of C++ does not.
std::optional<std::string> ask_person(const std::string& question) {
  std::cerr << question << std::flush;
  std::string answer;
  for (char character = 0; read(STDIN_FILENO, &character, 1) == 1;) {
    if (character == '\n') {
      return answer;
    }
    answer += character;
  }
  return std::nullopt;
}

}  // namespace

int main(int argc, char** argv) {
  static_cast<void>(std::signal(SIGPIPE, SIG_IGN));  // else it would end the program at a write
  ex9000::utility::Environment environment{ex9000::utility::open, std::cout, std::cerr,
                                           isatty(STDOUT_FILENO) != 0, isatty(STDERR_FILENO) != 0};
  if (isatty(STDIN_FILENO) != 0) {
    environment.ask_person = ask_person;
  }
  return ex9000::utility::run_program(argc, argv, environment);
}
