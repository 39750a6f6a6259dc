// A line with faults. Records the bytes that the master receives, the notices of the faults, and what
// WiresRecorder records.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/notation/fault_notation.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/virtual_line/line/line.hpp"
#include "tests/sim/virtual_line/wires/wires_recorder.hpp"

namespace ex9000::sim {

class FaultBench {
 public:
  /// Each of `modules` has the form that the simulator's command line requires. When the constructor returns,
  /// the modules have started and the line's time is 100 ms.
  explicit FaultBench(const std::vector<std::string>& modules = {"EX9042D@01"}, std::uint64_t seed = 1)
      : line_(specs(modules), kPaced, [this](std::uint8_t byte, ByteStatus status) {
          heard_.push_back(static_cast<char>(byte));
          garbled_ = garbled_ || status != ByteStatus::Good;
        }) {
    line_.wires().observe(recorder_);
    line_.come_up();
    line_.configure_faults(seed, [this](const std::string& text) { notices_.push_back(text); });
  }

  /// Adds a fault and returns its number. `position` is the module of the fault, counted from 1; nullopt: the
  /// fault is not limited to one module.
  std::size_t add(const std::string& text, std::optional<std::size_t> position = std::nullopt) {
    Fault fault = parse_fault(text);
    if (position) {
      fault.module = *position - 1;
    }
    return line_.faults().add(fault);
  }
  Faults& faults() { return line_.faults(); }
  Line& line() { return line_; }
  SimulatedModule& at(std::size_t position) { return line_.module(position - 1); }
  WiresRecorder& recorder() { return recorder_; }
  [[nodiscard]] VirtualTime now() { return line_.clock().virtual_now(); }
  void run(VirtualTime time) { line_.wires().run_for(time); }
  void run_until(VirtualTime time) { line_.wires().run_until(time); }

  void send(const std::string& text) {
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    line_.master().send(bytes.data(), bytes.size());
    while (line_.master().sending()) {
      line_.wires().run_until(line_.wires().next());
    }
  }
  /// Sends `command` and a CR, and then waits for the time `patience`. Returns everything that the master has
  /// received since the call. Removes a final CR from the result.
  std::string ask(const std::string& command, VirtualTime patience = std::chrono::milliseconds(50)) {
    forget();
    send(command + "\r");
    run(patience);
    return heard_.empty() || heard_.back() != '\r' ? heard_ : heard_.substr(0, heard_.size() - 1);
  }

  /// Returns everything that the master has received since the last `forget` or the start of the last `ask`,
  /// or since the construction of this object if neither has been called.
  [[nodiscard]] const std::string& heard() const { return heard_; }
  /// Returns whether at least one byte of `heard` had an error.
  [[nodiscard]] bool garbled() const { return garbled_; }
  void forget() {
    heard_.clear();
    garbled_ = false;
  }
  [[nodiscard]] const std::vector<std::string>& notices() const { return notices_; }

 private:
  static std::vector<ModuleSpec> specs(const std::vector<std::string>& modules) {
    std::vector<ModuleSpec> specs;
    for (const std::string& module : modules) {
      specs.push_back(parse_module_spec(module));
    }
    return specs;
  }

  Line line_;
  WiresRecorder recorder_;
  std::string heard_;
  bool garbled_ = false;
  std::vector<std::string> notices_;
};

inline const std::string kName = "!019042D";

inline std::vector<std::string> two() { return {"EX9042D@01", "EX9052D@02"}; }

/// Returns the start time and the value of each byte that neither the master nor a module has sent.
inline std::vector<std::pair<VirtualTime, int>> of_others(FaultBench& bench) {
  std::vector<std::pair<VirtualTime, int>> bytes;
  for (const WiresRecorder::Byte& byte : bench.recorder().bytes) {
    if (byte.station > bench.line().size()) {
      bytes.emplace_back(byte.start, byte.byte);
    }
  }
  return bytes;
}

/// Returns the times at which the module at `position` began to reply.
inline std::vector<VirtualTime> answers_of(FaultBench& bench, std::size_t position) {
  std::vector<VirtualTime> begun;
  for (const WiresRecorder::Driver& driver : bench.recorder().drivers) {
    if (driver.on && driver.station == position) {
      begun.push_back(driver.at);
    }
  }
  return begun;
}

/// Sends `requests` requests to the module at `address`. Returns one character for each request: `x` for a
/// reply that begins with `!` and the address and has no byte with an error, `.` for no reply, `?` for any
/// other reply.
inline std::string answered(FaultBench& bench, unsigned requests, const std::string& address = "01") {
  std::string which;
  for (unsigned i = 0; i < requests; ++i) {
    const std::string reply = bench.ask("$" + address + "M");
    which += reply.empty() ? '.' : reply.rfind("!" + address, 0) == 0 && !bench.garbled() ? 'x' : '?';
  }
  return which;
}

}  // namespace ex9000::sim
