#include "sim/app/main/program.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>
#include <csignal>
#include <iostream>
#include <stdexcept>
#include <string>

#include "sim/app/exports/description.hpp"
#include "sim/app/main/arguments.hpp"
#include "sim/app/main/play_record.hpp"
#include "sim/app/main/standard_stream.hpp"
#include "sim/app/play/play.hpp"
#include "sim/app/running_program/running_program.hpp"
#include "sim/files_and_ports/ports/stop_signals.hpp"

namespace ex9000::sim {

namespace {

constexpr int kCannotStart = 1;
constexpr int kFailed = 1;
constexpr auto kOutput = "standard output";

void run(const Setup& setup) {
  boost::asio::io_context io;
  StopSignals stop_signals;
  const auto gives_up = [&stop_signals] { return stop_signals.arrived(); };
  StandardStream output(STDOUT_FILENO, kOutput, gives_up);
  StandardStream errors(STDERR_FILENO, "standard error", gives_up);
  // When the reader of the log has closed the pipe, the program ends at the next write.
  const auto print_line = [&io, &output](const std::string& line) {
    if (!output.write(line + "\n")) {
      io.stop();
    }
  };
  boost::asio::signal_set signals(io);
  // Stops only `io`, so that destructors remove the control socket and the links to pseudo-terminals.
  add_stop_signals(signals);
  signals.async_wait([&io](const boost::system::error_code& /*error*/, int /*signal*/) { io.stop(); });
  const auto greet = [&errors](const std::string& text) { errors.write(text + "\n"); };
  RunningProgram running(io, setup, print_line, greet, setup.panel ? description(all_models()).dump() : "");
  running.start();
  if (setup.speed.max()) {
    running.run_unpaced();
  } else {
    io.run();
  }
  running.finish();
}

bool play_task(const play::Task& task) {
  StandardStream output(STDOUT_FILENO, kOutput);
  const auto print_line = [&output](const std::string& line) { output.write(line + "\n"); };
  const auto report = [](const std::string& line) { std::cerr << line << std::endl; };
  PlayRecord record(task.writing, print_line);
  if (task.writing.log == LogFormat::Json) {
    return play::play(task, report, record);  // standard output contains only the log
  }
  return play::play(task, print_line, record);
}

int report_error(const std::exception& error, int status) {
  std::cerr << one_line(std::string("ex9000-sim: ") + error.what()) << '\n';
  return status;
}

/// Opens /dev/null for those that are closed. Else a file that is opened later could get the descriptor of
/// standard output or standard error, and with it the log or the messages.
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

int run_program(int argc, const char* const* argv) {
  occupy_standard_streams();
  // Else they would end the program at a write to a closed pipe, or beyond the file-size limit.
  static_cast<void>(std::signal(SIGPIPE, SIG_IGN));
  static_cast<void>(std::signal(SIGXFSZ, SIG_IGN));
  try {
    const Parsed parsed = parse_arguments(argc, argv);
    StandardStream(STDOUT_FILENO, kOutput).write(parsed.output);
    std::cerr << parsed.error;
    if (parsed.task) {
      return play_task(*parsed.task) ? 0 : kFailed;
    }
    if (!parsed.setup) {
      return parsed.exit_status;
    }
    run(*parsed.setup);
  } catch (const std::invalid_argument& error) {
    return report_error(error, kWrongArguments);
  } catch (const std::exception& error) {
    return report_error(error, kCannotStart);
  }
  return 0;
}

}  // namespace ex9000::sim
