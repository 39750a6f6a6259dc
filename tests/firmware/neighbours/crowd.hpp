// 32 modules on one line. Each module has a reference model, which receives the same bytes.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "sim/virtual_line/line/line.hpp"
#include "tests/oracles/reference/module.hpp"
#include "tests/oracles/reference/random.hpp"

namespace ex9000::neighbours {

/// Sends pulses to the input channels 0 to 7 of one module at a constant rate, at the same instant on each
/// channel.
class Pulser final : public sim::Station {
 public:
  Pulser(sim::Wires& bus, sim::SimulatedModule& module)
      : clock_(bus.clock()), end_(bus.attach(*this)), module_(module) {}
  Pulser(const Pulser&) = delete;
  Pulser& operator=(const Pulser&) = delete;

  void start(std::uint32_t per_second);
  void stop() {
    period_ = sim::VirtualTime(0);
    pause();
  }
  void pause() { wake_at(sim::kNever); }
  void resume();
  /// Returns the number of pulses on each input since the last call.
  std::uint32_t take() { return std::exchange(pulses_, 0); }

  // --- sim::Station ---
  void run() override;

 private:
  void wake_at(sim::VirtualTime when) {
    next_ = when;
    end_.run_at(when);
  }

  sim::VirtualClock& clock_;
  sim::WireEnd& end_;
  sim::SimulatedModule& module_;
  sim::VirtualTime period_{0};
  sim::VirtualTime next_ = sim::kNever;
  std::uint32_t pulses_ = 0;
};

class Crowd final : public sim::WireObserver {
 public:
  static constexpr std::size_t kModules = 32;

  /// Creates 32 modules at the addresses 01 to 20 (hex). Most modules whose model supports Modbus use Modbus
  /// RTU. All other modules use ASCII and have the checksum enabled, because without the checksum the bytes
  /// of a Modbus frame could form a valid command.
  Crowd(std::uint32_t baud, std::uint64_t seed);

  [[nodiscard]] sim::VirtualTime now() { return line_.clock().virtual_now(); }
  Pulser& pulser() { return pulser_; }
  /// Sends one request to a random module, or a broadcast. Waits until the reply ends. If no reply is
  /// expected, waits until a reply would be too late. Checks the reply, its sender, and the outputs of all
  /// modules. The next call may follow immediately. Reports failures through GoogleTest.
  void exchange();

  [[nodiscard]] std::uint64_t replies() const { return replies_; }
  [[nodiscard]] std::uint64_t broadcasts() const { return broadcasts_; }
  /// Returns the number of replies to commands that stored something.
  [[nodiscard]] std::uint64_t stores() const { return stores_; }
  /// Returns the number of pulses on each input of the pulsed module until the last request began.
  [[nodiscard]] std::uint64_t pulses() const { return pulses_; }
  /// Returns, for each module, the outputs that were on after at least one exchange; bit n is channel n.
  [[nodiscard]] const std::vector<unsigned>& ever_on() const { return ever_on_; }
  [[nodiscard]] unsigned outputs_of(std::size_t module) const { return described_[module].row().outputs; }
  /// Returns the number of replies from each module.
  [[nodiscard]] const std::vector<std::uint64_t>& of_each() const { return of_each_; }

  // --- sim::WireObserver ---
  void driver(std::size_t station, bool on, sim::VirtualTime now) override;
  void byte(std::size_t /*station*/, std::uint8_t /*byte*/, hal::SerialMode /*mode*/, bool collided,
            sim::VirtualTime /*start*/, sim::VirtualTime /*end*/) override {
    collided_ = collided_ || collided;
  }

 private:
  reference::Bytes a_request(std::size_t module);
  reference::Bytes modbus_request(std::size_t module);
  std::string dcon_request(std::size_t module);
  void account_for_pulses();
  void expect_outputs_as_described();

  reference::Random random_;
  sim::Line line_;
  Pulser pulser_;
  std::vector<reference::Module> described_;
  reference::Bytes heard_;
  bool collided_ = false;
  std::vector<std::size_t> spoke_;
  std::uint64_t replies_ = 0;
  std::uint64_t broadcasts_ = 0;
  std::uint64_t stores_ = 0;
  std::uint64_t pulses_ = 0;
  std::vector<unsigned> ever_on_ = std::vector<unsigned>(kModules);
  std::vector<std::uint64_t> of_each_ = std::vector<std::uint64_t>(kModules);
};

}  // namespace ex9000::neighbours
