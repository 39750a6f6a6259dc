// Sends requests without pauses to two simulators with 32 modules each. Fails if a reply is missing or wrong,
// or if the memory of a simulator grows by more than 256 KiB after its first transactions. Also fails if a
// module requires more than 20 KiB of memory.
//
//     soak [SECONDS]    default: 600
#include <array>
#include <atomic>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "tests/masters/libmodbus_master.hpp"
#include "tests/support/control_client.hpp"
#include "tests/support/simulator_process.hpp"

namespace {

using ex9000::system::ControlClient;
using ex9000::system::LibmodbusMaster;
using ex9000::system::SimulatorProcess;
using Clock = std::chrono::steady_clock;

constexpr int kModules = 32;
constexpr int kBaud = 115200;
constexpr int kOutputs = 13;
constexpr int kInputs = 8;
/// The first transactions allocate memory that later transactions use again. A master completes this number
/// of transactions in about a second.
constexpr long kFirstTransactions = 200;
/// The permitted growth of the memory of a simulator after its first transactions, in KiB.
constexpr long kGrowth = 256;
constexpr double kMostOfAModule = 20;  // KiB

bool has_outputs(int address) { return address % 2 == 1; }

std::vector<std::string> modules(int count) {
  constexpr std::array<char, 17> kDigits{"0123456789ABCDEF"};
  std::vector<std::string> arguments;
  for (int address = 1; address <= count; ++address) {
    const auto byte = static_cast<unsigned>(address);
    arguments.push_back(std::string(has_outputs(address) ? "EX9042D-M@" : "EX9052D-M@") + kDigits[byte / 16] +
                        kDigits[byte % 16] + ",baud=" + std::to_string(kBaud));
  }
  arguments.insert(arguments.end(), {"--control", "control"});
  return arguments;
}

/// Returns the resident memory of a simulator, in KiB. Returns 0 if the system does not report it.
long memory_of(const SimulatorProcess& simulator) {
  std::ifstream status("/proc/" + std::to_string(simulator.pid()) + "/status");
  for (std::string line; std::getline(status, line);) {
    if (line.rfind("VmRSS:", 0) == 0) {
      return std::stol(line.substr(line.find(':') + 1));
    }
  }
  return 0;
}

/// Returns the memory that a module adds to a simulator, in KiB.
double memory_of_a_module() {
  constexpr int kMostModules = 247;
  return static_cast<double>(memory_of(SimulatorProcess(modules(kMostModules))) -
                             memory_of(SimulatorProcess(modules(1)))) /
         (kMostModules - 1);
}

/// A simulator with one line, the master of this line, and the expected state of the modules.
class Bus {
 public:
  void poll_until(Clock::time_point end) {
    while (Clock::now() < end) {
      for (int address = 1; address <= kModules; ++address) {
        if (has_outputs(address)) {
          move_an_output(address);
        } else {
          count_a_pulse(address);
        }
      }
      ++round_;
    }
  }

  [[nodiscard]] long transactions() const { return transactions_; }
  [[nodiscard]] long wrong() const { return wrong_; }
  [[nodiscard]] long memory() const { return memory_of(simulator_); }

 private:
  void move_an_output(int address) {
    const int channel = static_cast<int>(round_ % kOutputs);
    const int on = static_cast<int>(round_ / kOutputs % 2 == 0);
    judge(modbus_write_bit(master_.at(address), channel, on) == 1);
    std::array<std::uint8_t, kOutputs> bits{};
    judge(modbus_read_bits(master_.at(address), 0, kOutputs, bits.data()) == kOutputs &&
          bits[static_cast<std::size_t>(channel)] == on);
  }
  void count_a_pulse(int address) {
    const auto channel = static_cast<std::size_t>(round_ % kInputs);
    control_.ok(std::to_string(address) + " pulse " + std::to_string(channel));
    std::array<std::uint16_t, kInputs> counters{};
    judge(modbus_read_registers(master_.at(address), 0, kInputs, counters.data()) == kInputs &&
          counters[channel] == (round_ / kInputs + 1) % 65536);
  }
  void judge(bool right) {
    ++transactions_;
    wrong_ += right ? 0 : 1;
  }

  SimulatorProcess simulator_{modules(kModules)};
  LibmodbusMaster master_{simulator_.tty(), kBaud};
  ControlClient control_{simulator_.directory() + "/control"};
  long round_ = 0;
  std::atomic<long> transactions_{0};
  std::atomic<long> wrong_{0};
};

}  // namespace

int main(int argc, char** argv) {
  const long seconds = argc > 1 ? std::atol(argv[1]) : 600;
  if (argc > 2 || seconds < 1) {
    std::fprintf(stderr, "soak: expected one number of seconds, at least 1 (default: 600)\n");
    return 2;
  }
  std::array<Bus, 2> buses;
  const auto end = Clock::now() + std::chrono::seconds(seconds);
  std::vector<std::thread> masters;
  for (Bus& bus : buses) {
    masters.emplace_back([&bus, end] { bus.poll_until(end); });
  }
  std::array<long, 2> before{};
  for (std::size_t i = 0; i < buses.size(); ++i) {
    while (buses[i].transactions() < kFirstTransactions && Clock::now() < end) {
      std::this_thread::sleep_for(std::chrono::milliseconds(10));  // leaves the processor to the simulators
    }
    before[i] = buses[i].memory();
  }
  constexpr std::chrono::seconds kReportInterval{60};
  for (auto report = Clock::now() + kReportInterval; report < end; report += kReportInterval) {
    std::this_thread::sleep_until(report);
    std::printf("%ld and %ld transactions, %ld wrong\n", buses[0].transactions(), buses[1].transactions(),
                buses[0].wrong() + buses[1].wrong());
    std::fflush(stdout);
  }
  for (std::thread& master : masters) {
    master.join();
  }
  const double of_a_module = memory_of_a_module();
  std::printf("memory of a module: %.1f KiB (limit: %.0f KiB)\n", of_a_module, kMostOfAModule);
  bool passed = of_a_module <= kMostOfAModule;
  for (std::size_t i = 0; i < buses.size(); ++i) {
    const long grown = buses[i].memory() - before[i];
    std::printf("bus %zu: %ld transactions in %ld s, %ld wrong; %ld KiB, %+ld since the first transactions\n",
                i + 1, buses[i].transactions(), seconds, buses[i].wrong(), buses[i].memory(), grown);
    passed = passed && buses[i].wrong() == 0 && grown <= kGrowth && buses[i].transactions() > 0;
  }
  return passed ? 0 : 1;
}
