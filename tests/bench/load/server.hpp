// Measures the processor time of servers.
#pragma once

#include <time.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <optional>
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

/// Returns the sum of the busy times of all processors since the machine started, in seconds. The busy time
/// includes the time of all programs and of interrupts, and the time that a hypervisor has given to other
/// machines. Throws std::runtime_error if the system does not report these times.
inline double busy_seconds() {
  std::ifstream file("/proc/stat");
  std::string name;
  double user = 0;
  double nice = 0;
  double system = 0;
  double idle = 0;
  double waiting = 0;
  double interrupts = 0;
  double soft_interrupts = 0;
  double stolen = 0;
  if (!(file >> name >> user >> nice >> system >> idle >> waiting >> interrupts >> soft_interrupts >>
        stolen)) {
    throw std::runtime_error("/proc/stat cannot be read");
  }
  return (user + nice + system + interrupts + soft_interrupts + stolen) /
         static_cast<double>(sysconf(_SC_CLK_TCK));
}

/// A server, and a master that polls the units of the server in turn.
class Server {
 public:
  Server(std::string name, int pid, PollingMaster master, unsigned units)
      : name_(std::move(name)), pid_(pid), master_(std::move(master)), units_(units) {}

  void poll_for(std::chrono::milliseconds time, std::size_t round) {
    constexpr double kMostOfAProcessor = 0.1;  // the share of one processor that other programs may use
    const double before = processor_seconds(pid_);
    const double own_before = processor_seconds(getpid());
    const double all_before = busy_seconds();
    const auto began = std::chrono::steady_clock::now();
    const auto transactions = static_cast<double>(master_.poll_until(began + time, units_));
    const std::chrono::duration<double> took = std::chrono::steady_clock::now() - began;
    const double used = processor_seconds(pid_) - before;
    const double others = busy_seconds() - all_before - used - (processor_seconds(getpid()) - own_before);
    microseconds_.at(round) = 1e6 * used / transactions;
    rates_.at(round) = transactions / took.count();
    disturbed_.at(round) = others > kMostOfAProcessor * took.count();
  }

  [[nodiscard]] const std::string& name() const { return name_; }
  /// Returns the processor time of the server for a transaction, in microseconds: the median of all rounds.
  [[nodiscard]] double median() const { return median_of(microseconds_); }
  /// For each round, divides the processor time of this server for a transaction by that of `other`. Returns
  /// the smallest of these ratios. Ignores each round in which other programs disturbed the measurement of at
  /// least one of the two servers. Returns nullopt if other programs disturbed every round. Compares only
  /// results of the same round, because the speed of the machine can change from round to round.
  [[nodiscard]] std::optional<double> least_ratio_to(const Server& other) const {
    std::optional<double> result;
    for (std::size_t round = 0; round < kRounds; ++round) {
      const double ratio = microseconds_.at(round) / other.microseconds_.at(round);
      if (!disturbed_.at(round) && !other.disturbed_.at(round) && (!result || ratio < *result)) {
        result = ratio;
      }
    }
    return result;
  }
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
  std::array<bool, kRounds> disturbed_{};  ///< other programs used too much processor time in the round
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
