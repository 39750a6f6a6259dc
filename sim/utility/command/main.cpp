// ex9000: works with real and simulated modules on a line.
#include <unistd.h>

#include <csignal>
#include <iostream>

#include "sim/utility/command/program.hpp"

int main(int argc, char** argv) {
  static_cast<void>(std::signal(SIGPIPE, SIG_IGN));  // else it would end the program at a write
  ex9000::utility::Environment environment{ex9000::utility::open, std::cout, std::cerr,
                                           isatty(STDOUT_FILENO) != 0, isatty(STDERR_FILENO) != 0};
  return ex9000::utility::run_program(argc, argv, environment);
}
