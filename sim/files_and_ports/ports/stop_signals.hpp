// The signals that ask the program to end.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

namespace ex9000::sim {

/// SIGINT, SIGTERM, SIGHUP; not those that are ignored: SIGHUP by nohup, SIGINT in a script's background.
void add_stop_signals(boost::asio::signal_set& signals);

/// For code that computes for a long time or waits for a reader, while the program's io_context does not run.
class StopSignals {
 public:
  StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  /// Since construction. Does not block.
  bool arrived();

 private:
  boost::asio::io_context io_;
  boost::asio::signal_set signals_;
  bool arrived_ = false;
};

}  // namespace ex9000::sim
