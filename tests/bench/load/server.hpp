// Measures the processor time of servers.
#pragma once

#include <time.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tests/bench/load/polling_master.hpp"
#include "tests/support/simulator_process.hpp"

namespace ex9000::bench {

constexpr std::size_t kRounds = 7;

/// Waits until a server prints its first line, which shows that the server is ready, and returns this line.
/// Throws std::runtime_error if the server does not start.
inline std::string announced(system::ChildProcess& server) {
  if (!server.wait_for("\n")) {
    throw std::runtime_error("a server has not started");
  }
  return server.output().substr(0, server.output().find('\n'));
}

inline std::uint16_t port_of(system::ChildProcess& server) {
  return static_cast<std::uint16_t>(std::stoul(announced(server)));
}

/// Returns the processor time that the process has used, in seconds. Throws std::runtime_error if the system
/// does not report this time.
inline double processor_seconds(int pid) {
  clockid_t clock{};
  timespec time{};
  if (clock_getcpuclockid(pid, &clock) != 0 || clock_gettime(clock, &time) != 0) {
    throw std::runtime_error("the processor time of a server cannot be read");
  }
  return static_cast<double>(time.tv_sec) + static_cast<double>(time.tv_nsec) * 1e-9;
}

/// A server, and a master that polls the units of the server in turn.
class Server {
 public:
  Server(std::string name, int pid, PollingMaster master, unsigned units)
      : name_(std::move(name)), pid_(pid), master_(std::move(master)), units_(units) {}

  void poll_for(std::chrono::milliseconds time, std::size_t round) {
    const double before = processor_seconds(pid_);
    const auto began = std::chrono::steady_clock::now();
    const auto transactions = static_cast<double>(master_.poll_until(began + time, units_));
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    const double used = processor_seconds(pid_) - before;
    microseconds_.at(round) = 1e6 * used / transactions;
    rates_.at(round) = transactions / took.count();
  }

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Returns the processor time of the server for a transaction, in microseconds: the median of all rounds.
  [[nodiscard]] double median() const { return median_of(microseconds_); }
  /// Returns the number of transactions per second: the median of all rounds.
  [[nodiscard]] double rate() const { return median_of(rates_); }

 private:
  using Figures = std::array<double, kRounds>;

  static double median_of(Figures figures) {
    std::sort(figures.begin(), figures.end());
    return figures[kRounds / 2];
  }

  std::string name_;
  int pid_;
  PollingMaster master_;
  unsigned units_;
  Figures microseconds_{};
  Figures rates_{};
};

/// Polls each server for `time` in each round, and prints the medians of all rounds.
inline void measure(std::vector<Server>& servers, std::chrono::milliseconds time) {
  for (std::size_t round = 0; round < kRounds; ++round) {
    for (Server& server : servers) {
      server.poll_for(time, round);
    }
  }
  for (const Server& server : servers) {
    std::printf("  %-24s %6.1f us of processor time for each transaction, %6.0f transactions/s\n",
                server.name().c_str(), server.median(), server.rate());
  }
}

}  // namespace ex9000::bench
