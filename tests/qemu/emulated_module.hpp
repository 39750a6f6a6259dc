// A module in the host's time, for whoever keeps no other: foreign masters.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/qemu/emulated_board.hpp"

namespace ex9000::rig {

/// Its line takes no time, and knows no rates.
class EmulatedModule : public EmulatedBoard {
 public:
  EmulatedModule(const Model& model, const Settings* settings)
      : EmulatedBoard(model, settings, Emulator::Time::Host) {}

  /// The supply; see EmulatedBoard::supply.
  void power(bool on);
  /// Whether the image is about to be reset by its watchdog (`WATCHDOG`) or by itself (`SHUTDOWN`); waits 10
  /// s.
  bool halts_because(const std::string& event);
  /// That reset.
  void come_up_again();
  /// Level of an input channel; returns when the image has seen the edge.
  void set_input(unsigned channel, bool level);

  void send(const std::vector<std::uint8_t>& bytes);
  /// What the module has sent, once there is something; nothing where nothing came for `patience`.
  std::vector<std::uint8_t> hear(std::chrono::nanoseconds patience);
};

}  // namespace ex9000::rig
