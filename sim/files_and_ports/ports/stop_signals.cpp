#include "sim/files_and_ports/ports/stop_signals.hpp"

#include <csignal>

namespace ex9000::sim {

void add_stop_signals(boost::asio::signal_set& signals) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    struct sigaction action {};
    if (sigaction(signal, nullptr, &action) == 0 && action.sa_handler != SIG_IGN) {
      signals.add(signal);
    }
  }
}

StopSignals::StopSignals() : signals_(io_) {
  add_stop_signals(signals_);
  signals_.async_wait([this](const boost::system::error_code& error, int /*signal*/) { arrived_ = !error; });
}

bool StopSignals::arrived() {
  io_.poll();
  return arrived_;
}

}  // namespace ex9000::sim
