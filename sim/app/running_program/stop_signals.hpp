// The signals that ask the program to end.
#pragma once

#include <boost/asio/io_context.hpp>
#include <boost/asio/signal_set.hpp>

namespace ex9000::sim {

/// Adds SIGINT, SIGTERM and SIGHUP to `signals`, except those that the process ignores at this time. If nohup
/// has started the program, the process ignores SIGHUP. If a shell script has started the program in the
/// background, the process ignores SIGINT.
void add_stop_signals(boost::asio::signal_set& signals);

/// Detects the signals of `add_stop_signals` in code that computes for a long time or waits for a reader.
/// Such code may prevent the io_context of the program from running.
class StopSignals {
 public:
  StopSignals();
  StopSignals(const StopSignals&) = delete;
  StopSignals& operator=(const StopSignals&) = delete;

  /// Returns whether one of these signals has arrived since construction. Does not block.
  bool arrived();

 private:
  boost::asio::io_context io_;
  boost::asio::signal_set signals_;
  bool arrived_ = false;
};

}  // namespace ex9000::sim
