// One module and a master on a virtual line, for tests that exchange frames with the module.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/virtual_line/line/line.hpp"
#include "tests/sim/virtual_line/wires/wires_recorder.hpp"

namespace ex9000::sim {

struct OutputChange {
  VirtualTime at;
  std::uint16_t channels;
};

class ModuleBench {
 public:
  using Bytes = std::vector<std::uint8_t>;

  /// `module` is written as on the simulator's command line. When the constructor returns, 100 ms have passed
  /// since power-on.
  explicit ModuleBench(const std::string& module)
      : spec_(parse_module_spec(module)),
        line_({spec_}, kPaced, [this](std::uint8_t byte, ByteStatus /*status*/) { heard_.push_back(byte); }) {
    line_.wires().observe(recorder_);
    line_.come_up();
    line_.master().set_mode(line_.module(0).mode());
    recorder_.clear();
  }

  SimulatedModule& module() { return line_.module(0); }
  Line& line() { return line_; }
  WiresRecorder& recorder() { return recorder_; }
  [[nodiscard]] VirtualTime now() { return line_.clock().virtual_now(); }
  void run(VirtualTime time) { line_.wires().run_for(time); }

  void send(const Bytes& bytes) {
    line_.master().send(bytes.data(), bytes.size());
    while (line_.master().sending()) {
      line_.wires().run_until(line_.wires().next());
    }
  }
  void send(const std::string& text) { send(Bytes(text.begin(), text.end())); }

  /// Sends a command; the bench adds the CR. Waits for 250 ms in every case, and returns the reply without
  /// CR; empty if none arrived.
  std::string ask(const std::string& command) {
    heard_.clear();
    send(command + "\r");
    run(std::chrono::milliseconds(250));
    std::string reply(heard_.begin(), heard_.end());
    if (!reply.empty() && reply.back() == '\r') {
      reply.pop_back();
    }
    return reply;
  }

  /// Sends a frame; the bench adds the CRC. Waits for 250 ms in every case, and returns the reply without
  /// CRC; empty if none arrived.
  Bytes ask(const Bytes& frame) {
    heard_.clear();
    send(with_crc(frame));
    run(std::chrono::milliseconds(250));
    Bytes reply = heard_;
    if (reply.size() > 2) {
      reply.resize(reply.size() - 2);
    }
    return reply;
  }

  /// Returns all characters that the master has received since the beginning of the last call of `ask`, or
  /// since construction.
  [[nodiscard]] std::string heard_text() const { return {heard_.begin(), heard_.end()}; }

  /// Appends every change of the outputs to `changes` until the next call of `watch_outputs`. `changes` must
  /// exist until that call. If there is no such call, `changes` must exist as long as the outputs can change.
  void watch_outputs(std::vector<OutputChange>& changes) {
    module().output_pins().on_change([this, &changes](std::uint16_t channels) {
      changes.push_back({now(), channels});
    });
  }

  void power_cycle() {
    module().power(false);
    module().power(true);
    run(std::chrono::milliseconds(100));
  }

 private:
  ModuleSpec spec_;
  Line line_;
  WiresRecorder recorder_;
  Bytes heard_;
};

}  // namespace ex9000::sim
