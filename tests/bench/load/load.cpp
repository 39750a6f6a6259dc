// Measures the throughput of the simulator: first one line, compared with servers that use libmodbus and
// pymodbus; then eight lines of 32 modules in one process.
//
//     load [--without pymodbus] [MILLISECONDS]    duration of each measurement; default 1000
#include <unistd.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/bench/load/polling_master.hpp"
#include "tests/support/simulator_process.hpp"

namespace {

using ex9000::bench::PollingMaster;
using ex9000::system::ChildProcess;
using ex9000::system::Directory;
using ex9000::system::SimulatorProcess;
using Clock = std::chrono::steady_clock;

constexpr std::size_t kRounds = 5;
constexpr unsigned kLines = 8;
constexpr unsigned kModules = 32;

/// Returns the word that a server prints when it is ready. Throws std::runtime_error if the server does not
/// start.
std::string announced(ChildProcess& server) {
  if (!server.wait_for("\n")) {
    throw std::runtime_error("a server has not started");
  }
  return server.output().substr(0, server.output().find('\n'));
}

struct Peer {
  const char* name;
  PollingMaster master;
  std::array<double, kRounds> rates{};

  [[nodiscard]] double median() const {
    auto sorted = rates;
    std::sort(sorted.begin(), sorted.end());
    return sorted[kRounds / 2];
  }
};

/// Returns the transactions per second.
double rate_of(PollingMaster& master, std::chrono::milliseconds time) {
  const auto began = Clock::now();
  const auto transactions = static_cast<double>(master.poll_until(began + time, 1));
  return transactions / std::chrono::duration<double>(Clock::now() - began).count();
}

void compare(std::chrono::milliseconds time, bool with_pymodbus) {
  SimulatorProcess simulator({"EX9042D-M@01", "--tcp", "0", "--line", "instant"});
  SimulatorProcess other_simulator({"EX9042D-M@01", "--line", "instant"});
  ChildProcess libmodbus({EX9000_LIBMODBUS_SERVER}, "/");
  std::optional<ChildProcess> pymodbus;
  std::optional<ChildProcess> pymodbus_tcp;
  std::vector<Peer> peers;
  peers.push_back({"ex9000-sim, TCP", PollingMaster::over_tcp(simulator.tcp_port())});
  peers.push_back({"ex9000-sim, pseudo-terminal", PollingMaster::over_tty(other_simulator.tty())});
  peers.push_back({"libmodbus, pseudo-terminal", PollingMaster::over_tty(announced(libmodbus))});
  if (with_pymodbus) {
    std::string tty;
    peers.push_back({"pymodbus, pseudo-terminal", PollingMaster::over_new_tty(tty)});
    announced(
        pymodbus.emplace(std::vector<std::string>{"/usr/bin/python3", EX9000_PYMODBUS_SERVER, tty}, "/"));
    pymodbus_tcp.emplace(std::vector<std::string>{"/usr/bin/python3", EX9000_PYMODBUS_SERVER}, "/");
    const auto port = static_cast<std::uint16_t>(std::stoul(announced(*pymodbus_tcp)));
    peers.push_back({"pymodbus, TCP", PollingMaster::over_tcp(port)});
  }
  for (std::size_t round = 0; round < kRounds; ++round) {
    for (Peer& peer : peers) {
      peer.rates[round] = rate_of(peer.master, time);
    }
  }
  std::printf("one line, FC01 x 13 back to back, median of %zu rounds in turn:\n", kRounds);
  for (const Peer& peer : peers) {
    std::printf("  %-28s %8.0f transactions/s; ex9000-sim over TCP: %5.2f times as many\n", peer.name,
                peer.median(), peers[0].median() / peer.median());
  }
}

std::string bus_file() {
  std::ostringstream file;
  file << "{\"lines\": [";
  for (unsigned line = 0; line < kLines; ++line) {
    file << (line == 0 ? "" : ",\n") << R"({"tcp": "127.0.0.1:0", "line": "instant", "modules": [)";
    for (unsigned module = 1; module <= kModules; ++module) {
      std::array<char, 8> address{};
      std::snprintf(address.data(), address.size(), "%02X", module);
      file << (module == 1 ? "" : ", ") << R"({"model": "EX9042D-M", "address": ")" << address.data()
           << "\"}";
    }
    file << "]}";
  }
  file << "]}\n";
  return file.str();
}

/// Returns all TCP ports in a greeting.
std::vector<std::uint16_t> ports_of(const std::string& greeting) {
  const std::string lead = "TCP 127.0.0.1:";
  std::vector<std::uint16_t> ports;
  for (auto at = greeting.find(lead); at != std::string::npos; at = greeting.find(lead, at + 1)) {
    ports.push_back(static_cast<std::uint16_t>(std::stoul(greeting.substr(at + lead.size(), 5))));
  }
  return ports;
}

/// Returns the processor time that the process has used, in seconds: utime and stime of proc(5).
double processor_seconds(int pid) {
  std::ifstream file("/proc/" + std::to_string(pid) + "/stat");
  std::string text;
  std::getline(file, text);
  std::istringstream words(text.substr(text.rfind(')') + 1));
  std::string word;
  double ticks = 0;
  constexpr int kUser = 12;  // field numbers after the process name
  constexpr int kSystem = 13;
  for (int i = 1; words >> word && i <= kSystem; ++i) {
    ticks += i == kUser || i == kSystem ? std::stod(word) : 0;
  }
  return ticks / static_cast<double>(sysconf(_SC_CLK_TCK));
}

/// Returns the resident memory, in KiB.
long memory_of(int pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) {
      return std::stol(line.substr(line.find(':') + 1));
    }
  }
  return 0;
}

void load(std::chrono::milliseconds time) {
  const Directory directory;
  ex9000::system::write_file(directory / "bus.json", bus_file());
  ChildProcess simulator({ex9000::system::simulator_path(), "bus.json"}, directory.path());
  if (!simulator.wait_for("press Ctrl-C to end")) {
    throw std::runtime_error("the simulator has not started");
  }
  std::array<std::uint64_t, kLines> transactions{};
  const double before = processor_seconds(simulator.pid());
  const auto began = Clock::now();
  std::vector<std::thread> masters;
  const std::vector<std::uint16_t> ports = ports_of(simulator.output());
  for (std::size_t line = 0; line < ports.size(); ++line) {
    masters.emplace_back([&, line] {
      PollingMaster master = PollingMaster::over_tcp(ports[line]);
      transactions.at(line) = master.poll_until(began + time, kModules);
    });
  }
  for (std::thread& master : masters) {
    master.join();
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - began).count();
  std::uint64_t all = 0;
  for (const std::uint64_t each : transactions) {
    all += each;
  }
  std::printf(
      "%zu lines of %u modules in one process: %.0f transactions/s in all, %ld KiB, %.0f %% of a processor\n",
      ports.size(), kModules, static_cast<double>(all) / seconds, memory_of(simulator.pid()),
      100 * (processor_seconds(simulator.pid()) - before) / seconds);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool alone = arguments.size() > 1 && arguments[0] == "--without" && arguments[1] == "pymodbus";
  arguments.erase(arguments.begin(), arguments.begin() + (alone ? 2 : 0));
  const long milliseconds = arguments.empty() ? 1000 : std::atol(arguments[0].c_str());
  if (arguments.size() > 1 || milliseconds < 1) {
    std::fprintf(stderr, "load: expected a number of milliseconds (default: 1000)\n");
    return 2;
  }
  try {
    compare(std::chrono::milliseconds(milliseconds), !alone);
    load(std::chrono::milliseconds(milliseconds * static_cast<long>(kRounds)));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "load: %s\n", error.what());
    return 1;
  }
  return 0;
}
