// ex9000-sim: simulated modules on a line that masters reach.
#include <fcntl.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <csignal>
#include <iostream>
#include <stdexcept>
#include <string>

#include "sim/arguments.hpp"
#include "sim/session.hpp"

namespace {

using namespace ex9000::sim;

constexpr int kCannotStart = 1;

void run(const Arguments& arguments) {
  boost::asio::io_context io;
  // Flushed, since a log is read while it grows; who closes the pipe behind it ends the program.
  const auto print = [&io](const std::string& line) {
    std::cout << line << std::endl;
    if (!std::cout) {
      io.stop();
    }
  };
  Session session(io, arguments, print);
  boost::asio::signal_set signals(io, SIGINT, SIGTERM, SIGHUP);
  signals.async_wait([&io](const boost::system::error_code& /*error*/, int /*signal*/) { io.stop(); });
  session.start();
  io.run();
}

/// Where one of the three is closed, the next file would take its number, and a log be written into the line.
void occupy_standard_streams() {
  int fd = open("/dev/null", O_RDWR);
  while (fd >= 0 && fd <= STDERR_FILENO) {
    fd = open("/dev/null", O_RDWR);
  }
  if (fd >= 0) {
    close(fd);
  }
}

}  // namespace

int main(int argc, char** argv) {
  occupy_standard_streams();
  const Parsed parsed = parse_arguments(argc, argv);
  std::cout << parsed.output;
  std::cerr << parsed.error;
  if (!parsed.arguments) {
    return parsed.exit_status;
  }
  static_cast<void>(std::signal(SIGPIPE, SIG_IGN));  // a write to a closed pipe fails, and that is looked at
  try {
    run(*parsed.arguments);
  } catch (const std::invalid_argument& error) {
    std::cerr << "ex9000-sim: " << error.what() << '\n';
    return kWrongArguments;
  } catch (const std::exception& error) {
    std::cerr << "ex9000-sim: " << error.what() << '\n';
    return kCannotStart;
  }
  return 0;
}
