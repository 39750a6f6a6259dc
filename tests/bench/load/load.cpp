// Compares the simulator with a libmodbus server and a pymodbus server on the same transport: the processor
// time that each program uses for a transaction. Then measures the cost of many modules and of many lines,
// and the memory of a module.
//
//     load [--without pymodbus] [MILLISECONDS]    how long to poll each server in each round; default: 1000
//
// Fails if a module requires too much memory. The processor times have no limit here, because they depend on
// the machine, above all on the cost of its system calls; tests/bench/simulator_instructions limits the
// instructions.
#include <sched.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/bench/load/polling_master.hpp"
#include "tests/bench/load/server.hpp"

namespace {

using namespace ex9000::bench;
using ex9000::system::ChildProcess;
using ex9000::system::Directory;
using ex9000::system::simulator_path;
using ex9000::system::SimulatorProcess;
using Clock = std::chrono::steady_clock;
using std::chrono::milliseconds;

constexpr unsigned kLines = 8;
constexpr unsigned kModules = 32;
constexpr unsigned kMostModules = 247;

bool failed = false;

/// Prints a ratio with its target.
void print(const std::string& what, double ratio, double target) {
  std::printf("  %s: %.2f (target: %.2f)\n", what.c_str(), ratio, target);
}

/// Prints a value with its target and its limit. If the value is above the limit, the program fails when it
/// ends.
void judge(const std::string& what, double ratio, double target, double limit) {
  std::printf("  %s: %.2f (target: %.2f, limit: %.2f)%s\n", what.c_str(), ratio, target, limit,
              ratio > limit ? "  TOO MUCH" : "");
  failed = failed || ratio > limit;
}

/// Restricts the calling thread to one processor while this object exists. The servers that the thread starts
/// during this time inherit the restriction. On two processors, the wake-up of another program sometimes
/// requires ten times the processor time of a transaction, and sometimes no time. This cost changes from
/// round to round.
class OneProcessor {
 public:
  OneProcessor() {
    sched_getaffinity(0, sizeof all_, &all_);
    cpu_set_t one;
    CPU_ZERO(&one);
    CPU_SET(static_cast<std::size_t>(sched_getcpu()), &one);
    sched_setaffinity(0, sizeof one, &one);
  }
  OneProcessor(const OneProcessor&) = delete;
  OneProcessor& operator=(const OneProcessor&) = delete;
  ~OneProcessor() { sched_setaffinity(0, sizeof all_, &all_); }

 private:
  cpu_set_t all_{};
};

std::vector<std::string> line_of(unsigned modules) {
  std::vector<std::string> arguments;
  for (unsigned address = 1; address <= modules; ++address) {
    std::array<char, 8> hex{};
    std::snprintf(hex.data(), hex.size(), "%02X", address);
    arguments.push_back(std::string("EX9042D-M@") + hex.data());
  }
  arguments.insert(arguments.end(), {"--timing", "instant"});
  return arguments;
}

std::vector<std::string> over_tcp(std::vector<std::string> arguments) {
  arguments.insert(arguments.end(), {"--port", "tcp:0"});
  return arguments;
}

std::unique_ptr<ChildProcess> pymodbus_server(const std::vector<std::string>& arguments) {
  std::vector<std::string> command{"/usr/bin/python3", EX9000_PYMODBUS_SERVER};
  command.insert(command.end(), arguments.begin(), arguments.end());
  return std::make_unique<ChildProcess>(command, "/");
}

/// Measures one module over TCP and over a pseudo-terminal, and compares it with the other servers.
void compare_one_module(milliseconds time, bool with_pymodbus) {
  const SimulatorProcess tcp_simulator(over_tcp(line_of(1)));
  const SimulatorProcess tty_simulator(line_of(1));
  ChildProcess tcp_libmodbus({EX9000_LIBMODBUS_SERVER, "tcp"}, "/");
  ChildProcess tty_libmodbus({EX9000_LIBMODBUS_SERVER}, "/");
  std::vector<Server> tcp;
  tcp.emplace_back("ex9000-sim", tcp_simulator.pid(), PollingMaster::over_tcp(tcp_simulator.tcp_port()), 1);
  tcp.emplace_back("libmodbus", tcp_libmodbus.pid(), PollingMaster::over_tcp(port_of(tcp_libmodbus)), 1);
  std::vector<Server> tty;
  tty.emplace_back("ex9000-sim", tty_simulator.pid(), PollingMaster::over_tty(tty_simulator.tty()), 1);
  tty.emplace_back("libmodbus", tty_libmodbus.pid(), PollingMaster::over_tty(announced(tty_libmodbus)), 1);
  std::vector<std::unique_ptr<ChildProcess>> pymodbus;
  if (with_pymodbus) {
    pymodbus.push_back(pymodbus_server({"tcp", "1"}));
    tcp.emplace_back("pymodbus", pymodbus[0]->pid(), PollingMaster::over_tcp(port_of(*pymodbus[0])), 1);
    std::string path;
    PollingMaster master = PollingMaster::over_new_tty(path);
    pymodbus.push_back(pymodbus_server({path, "1"}));
    announced(*pymodbus[1]);
    tty.emplace_back("pymodbus", pymodbus[1]->pid(), std::move(master), 1);
  }
  for (auto& [transport, servers] : {std::pair<const char*, std::vector<Server>&>{"TCP", tcp},
                                     std::pair<const char*, std::vector<Server>&>{"pseudo-terminal", tty}}) {
    std::printf("one module over %s:\n", transport);
    measure(servers, time);
    print("ex9000-sim / libmodbus", servers[0].median() / servers[1].median(), &servers == &tcp ? 0.9 : 1.5);
  }
}

/// Measures one line with 1, 32 and 247 modules. If `with_pymodbus`, also measures pymodbus servers with 32
/// and 247 units, and compares the simulator with them.
void compare_modules(milliseconds time, bool with_pymodbus) {
  const std::array<unsigned, 3> sizes{1, kModules, kMostModules};
  std::vector<std::unique_ptr<SimulatorProcess>> simulators;
  std::vector<std::unique_ptr<ChildProcess>> pymodbus;
  std::vector<Server> servers;
  for (const unsigned size : sizes) {
    simulators.push_back(std::make_unique<SimulatorProcess>(over_tcp(line_of(size))));
    servers.emplace_back("ex9000-sim, " + std::to_string(size) + " modules", simulators.back()->pid(),
                         PollingMaster::over_tcp(simulators.back()->tcp_port()), size);
  }
  for (std::size_t i = 1; with_pymodbus && i < sizes.size(); ++i) {
    pymodbus.push_back(pymodbus_server({"tcp", std::to_string(sizes[i])}));
    servers.emplace_back("pymodbus, " + std::to_string(sizes[i]) + " units", pymodbus.back()->pid(),
                         PollingMaster::over_tcp(port_of(*pymodbus.back())), sizes[i]);
  }
  std::printf("modules on one line, polled in turn over TCP:\n");
  measure(servers, time);
  print("32 modules / one module", servers[1].median() / servers[0].median(), 1.15);
  print("247 modules / one module", servers[2].median() / servers[0].median(), 1.5);
  for (std::size_t i = sizes.size(); i < servers.size(); ++i) {
    const Server& ours = servers[i - sizes.size() + 1];
    print(ours.name() + " / pymodbus", ours.median() / servers[i].median(), 1);
  }
}

std::string bus_file() {
  std::ostringstream file;
  file << "{\"lines\": [";
  for (unsigned line = 0; line < kLines; ++line) {
    file << (line == 0 ? "" : ",\n") << R"({"port": "tcp:127.0.0.1:0", "timing": "instant", "modules": [)";
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

/// Returns all TCP ports in a greeting of the simulator.
std::vector<std::uint16_t> ports_of(const std::string& greeting) {
  const std::string lead = "TCP 127.0.0.1:";
  std::vector<std::uint16_t> ports;
  for (auto at = greeting.find(lead); at != std::string::npos; at = greeting.find(lead, at + 1)) {
    ports.push_back(static_cast<std::uint16_t>(std::stoul(greeting.substr(at + lead.size(), 5))));
  }
  return ports;
}

/// Returns the resident memory of a process, in KiB; 0 if the system does not report it.
double memory_of(int pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) {
      return std::stod(line.substr(line.find(':') + 1));
    }
  }
  return 0;
}

/// Measures eight lines in one process, each with its own master, and judges the memory of a module. Throws
/// std::runtime_error if the simulator does not start, or if the system does not report its processor time.
void load(milliseconds time) {
  const Directory directory;
  ex9000::system::write_file(directory / "bus.json", bus_file());
  ChildProcess simulator({simulator_path(), "bus.json"}, directory.path());
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
  double all = 0;
  for (const std::uint64_t each : transactions) {
    all += static_cast<double>(each);
  }
  const double used = processor_seconds(simulator.pid()) - before;
  const double microseconds = 1e6 * used / all;
  std::printf("  %6.0f transactions/s, %.0f %% of a processor, %.1f us for each transaction\n", all / seconds,
              100 * used / seconds, microseconds);
  const SimulatorProcess small(over_tcp(line_of(1)));
  judge("memory, KiB for each module",
        (memory_of(simulator.pid()) - memory_of(small.pid())) / (kLines * kModules - 1), 16, 16);
}

}  // namespace

int main(int argc, char** argv) {
  std::vector<std::string> arguments(argv + 1, argv + argc);
  const bool alone = arguments.size() > 1 && arguments[0] == "--without" && arguments[1] == "pymodbus";
  arguments.erase(arguments.begin(), arguments.begin() + (alone ? 2 : 0));
  const long number = arguments.empty() ? 1000 : std::atol(arguments[0].c_str());
  if (arguments.size() > 1 || number < 1) {
    std::fprintf(stderr,
                 "load: wrong arguments; expected [--without pymodbus] [MILLISECONDS]; MILLISECONDS is a "
                 "decimal number of at least 1\n");
    return 2;
  }
  try {
    const milliseconds time(number);
    std::printf("reads of 13 coils with FC01 without a pause, on an instant line; medians of %zu rounds\n",
                kRounds);
    {
      const OneProcessor one_processor;
      compare_one_module(time, !alone);
      compare_modules(time, !alone);
    }
    std::printf("%u lines of %u modules in one process, with a master on each line:\n", kLines, kModules);
    load(time * kRounds);
  } catch (const std::exception& error) {
    std::fprintf(stderr, "load: %s\n", error.what());
    return 1;
  }
  return failed ? 1 : 0;
}
