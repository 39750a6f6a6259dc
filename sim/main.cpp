// ex9000-sim: simulated modules on a pseudo-terminal.
#include <fcntl.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <csignal>
#include <iostream>
#include <stdexcept>
#include <string>

#include "sim/arguments.hpp"
#include "sim/bus_log.hpp"
#include "sim/greeting.hpp"
#include "sim/line.hpp"
#include "sim/pacer.hpp"
#include "sim/pty.hpp"

namespace {

using namespace ex9000::sim;

constexpr int kCannotStart = 1;

std::vector<std::string> speakers(const Arguments& arguments) {
  std::vector<std::string> names{"master"};
  for (const ModuleSpec& spec : arguments.modules) {
    names.push_back(hex_byte_text(spec.address()) + " " + std::string(spec.model->designation));
  }
  return names;
}

void run(const Arguments& arguments) {
  Pty pty(arguments.pty_link, arguments.line_baud());
  boost::asio::io_context io;
  // Flushed, since a log is read while it grows; who closes the pipe behind it ends the program.
  const auto print = [&io](const std::string& line) {
    std::cout << line << std::endl;
    if (!std::cout) {
      io.stop();
    }
  };
  Pacer* pacer = nullptr;
  const ex9000::InterCharacterGap gap =
      arguments.strict_gaps ? ex9000::InterCharacterGap::Refused : ex9000::InterCharacterGap::Tolerated;
  Line line(arguments.modules, arguments.line_baud(), gap,
            [&pacer](std::uint8_t byte, ex9000::ByteStatus /*status*/) { pacer->hear(byte); });
  BusLog log(speakers(arguments), print);
  if (arguments.log) {
    line.bus().observe(log);
  }
  Pacer paced(io, line, pty, arguments.log ? &log : nullptr, gap,
              [&](const std::string& text) { log.note(line.clock().virtual_now(), text); });
  pacer = &paced;

  boost::asio::signal_set signals(io, SIGINT, SIGTERM, SIGHUP);
  signals.async_wait([&io](const boost::system::error_code& /*error*/, int /*signal*/) { io.stop(); });
  print(greeting(arguments, pty.device()));
  paced.start();
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
