// A line with faults, a master, and somebody who writes down what is heard.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "sim/line/line.hpp"
#include "tests/sim/bus/bus_recorder.hpp"

namespace ex9000::sim {

class FaultBench {
 public:
  /// `modules` as on the simulator's command line; 100 ms have passed since power-on.
  explicit FaultBench(const std::vector<std::string>& modules = {"EX9042D@01"}, std::uint64_t seed = 1)
      : line_(specs(modules), kPaced, [this](std::uint8_t byte, ByteStatus status) {
          heard_.push_back(static_cast<char>(byte));
          garbled_ = garbled_ || status != ByteStatus::Good;
        }) {
    line_.bus().observe(recorder_);
    line_.come_up();
    line_.expect_trouble(seed, [this](const std::string& text) { notices_.push_back(text); });
  }

  /// Of the module at `position`, from 1, where there is one.
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
  BusRecorder& recorder() { return recorder_; }
  [[nodiscard]] VirtualTime now() { return line_.clock().virtual_now(); }
  void run(VirtualTime time) { line_.bus().run_for(time); }
  void run_until(VirtualTime time) { line_.bus().run_until(time); }

  void send(const std::string& text) {
    const std::vector<std::uint8_t> bytes(text.begin(), text.end());
    line_.master().send(bytes.data(), bytes.size());
    while (line_.master().sending()) {
      line_.bus().run_until(line_.bus().next());
    }
  }
  /// A DCON command without its CR, and all that is heard within `patience`, likewise.
  std::string ask(const std::string& command, VirtualTime patience = std::chrono::milliseconds(50)) {
    forget();
    send(command + "\r");
    run(patience);
    return heard_.empty() || heard_.back() != '\r' ? heard_ : heard_.substr(0, heard_.size() - 1);
  }

  /// All since it was forgotten.
  [[nodiscard]] const std::string& heard() const { return heard_; }
  /// Whether there were errors among it.
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
  BusRecorder recorder_;
  std::string heard_;
  bool garbled_ = false;
  std::vector<std::string> notices_;
};

inline const std::string kName = "!019042D";

inline std::vector<std::string> two() { return {"EX9042D@01", "EX9052D@02"}; }

/// When each byte that is none of the master's or of the only module's began, and its value.
inline std::vector<std::pair<VirtualTime, int>> of_others(FaultBench& bench) {
  std::vector<std::pair<VirtualTime, int>> bytes;
  for (const BusRecorder::Byte& byte : bench.recorder().bytes) {
    if (byte.station > bench.line().size()) {
      bytes.emplace_back(byte.start, byte.byte);
    }
  }
  return bytes;
}

/// When the module at `position` has begun to answer.
inline std::vector<VirtualTime> answers_of(FaultBench& bench, std::size_t position) {
  std::vector<VirtualTime> begun;
  for (const BusRecorder::Driver& driver : bench.recorder().drivers) {
    if (driver.on && driver.station == position) {
      begun.push_back(driver.at);
    }
  }
  return begun;
}

/// Which of so many requests are answered: `.` those that are not.
inline std::string answered(FaultBench& bench, unsigned requests, const std::string& address = "01") {
  std::string which;
  for (unsigned i = 0; i < requests; ++i) {
    const std::string reply = bench.ask("$" + address + "M");
    which += reply.empty() ? '.' : reply.rfind("!" + address, 0) == 0 && !bench.garbled() ? 'x' : '?';
  }
  return which;
}

}  // namespace ex9000::sim
