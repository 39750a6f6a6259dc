// The signals that ask the program to end.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

namespace ex9000::sim {

/// Adds SIGINT, SIGTERM and SIGHUP, except those that were ignored when the program started: nohup ignores
/// SIGHUP, and shells ignore SIGINT for background jobs.
void add_stop_signals(boost::asio::signal_set& signals);

/// Detects these signals while a long computation prevents the io_context of the program from running.
class StopSignals {
 public:
  StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  /// Returns whether a signal has arrived since construction. Does not block.
  bool arrived();

 private:
  boost::asio::io_context io_;
  boost::asio::signal_set signals_;
  bool arrived_ = false;
};

}  // namespace ex9000::sim
