// Connects a witness to a simulated module. The witness checks each change of the outputs immediately, and
// each reply at its end.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <cstdint>
#include <vector>

#include "sim/virtual_line/wires/module.hpp"
#include "sim/virtual_line/wires/wires.hpp"
#include "tests/oracles/judges/module_state.hpp"
#include "tests/oracles/judges/witness.hpp"

namespace ex9000::noise {

/// Reports failures through GoogleTest.
class Onlooker final : public sim::WireObserver {
 public:
  /// `module` and this object must live as long as the bus is used. Nothing else may observe the module's
  /// outputs. `station`: the module's number on the bus.
  Onlooker(sim::Wires& bus, sim::SimulatedModule& module, std::size_t station)
      : clock_(bus.clock()),
        module_(module),
        station_(station),
        witness_(module.model(), [](const char* claim) { ADD_FAILURE() << "does not hold: " << claim; }) {
    bus.observe(*this);
    module.output_pins().on_change([this](std::uint16_t /*channels*/) {
      if (checking_) {
        ++replies_and_output_changes_;
        witness_.follow(values(), now());
      }
    });
  }
  Onlooker(const Onlooker&) = delete;
  Onlooker& operator=(const Onlooker&) = delete;

  /// Stops checking. Call this before the module is switched off.
  void stop_checking() { checking_ = false; }
  /// Begins to check. Call this when the module has started, before anything is sent to it.
  void start_checking() {
    judges::Listening listening = judges::listening_of(module_.module().state());
    // The greatest difference between the module's clock and the clock of the witness.
    constexpr judges::Microseconds kDoubt = 8;
    listening.doubt = kDoubt;
    witness_.comes_up(listening, values(), now());
    checking_ = true;
  }

  /// Passes `byte` to the witness, unless the module's driver is on. Call this for each byte that arrives at
  /// the module. It is possible that the module has not processed the byte yet.
  void hears(std::uint8_t byte, ByteStatus status) {
    if (!driving_) {
      witness_.hears(byte, status == ByteStatus::Good, module_.module().state().in_force.address, now());
    }
  }

  /// Returns the counts of frames that the module has received until now.
  const judges::Witness::Counts& counts() {
    witness_.pass(now());
    return witness_.counts();
  }
  [[nodiscard]] std::uint64_t replies() const { return replies_; }
  /// Returns the number of replies plus the number of changes of outputs.
  [[nodiscard]] std::uint64_t replies_and_output_changes() const { return replies_and_output_changes_; }

  // --- sim::WireObserver ---
  void driver(std::size_t station, bool on, sim::VirtualTime /*now*/) override {
    if (station != station_ || !checking_) {
      return;
    }
    driving_ = on;
    if (on) {
      ++replies_;
      ++replies_and_output_changes_;
      began_ = now();
      reply_.clear();
      witness_.follow(values(), began_);
    } else {
      witness_.reply_begins({reply_.data(), reply_.size()}, began_);
      witness_.reply_ends(now());
    }
  }
  void byte(std::size_t station, std::uint8_t byte, hal::SerialMode /*mode*/, bool /*collided*/,
            sim::VirtualTime /*start*/, sim::VirtualTime /*end*/) override {
    if (station == station_) {
      reply_.push_back(byte);
    }
  }

 private:
  [[nodiscard]] judges::Microseconds now() const {
    return static_cast<judges::Microseconds>(
        std::chrono::duration_cast<std::chrono::microseconds>(clock_.virtual_now()).count());
  }
  [[nodiscard]] judges::Values values() const {
    return judges::values_of(module_.module().state(), module_.outputs());
  }

  sim::VirtualClock& clock_;
  sim::SimulatedModule& module_;
  std::size_t station_;
  judges::Witness witness_;
  bool checking_ = false;
  bool driving_ = false;
  judges::Microseconds began_ = 0;
  std::vector<std::uint8_t> reply_;
  std::uint64_t replies_ = 0;
  std::uint64_t replies_and_output_changes_ = 0;
};

}  // namespace ex9000::noise
