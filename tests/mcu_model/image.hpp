// A firmware image as a host can run it: the composition of a board and a model with all its drivers,
// compiled as it stands, its bus leading to registers::Microcontroller. Each is a shared object of its own,
// for what a model lacks is not compiled, so that no two of them agree on what the core is.
#pragma once

#include <array>
#include <cstdint>
#include <string>

#include "tests/mcu_model/chip.hpp"

namespace ex9000::registers {

struct PinPlace {
  char port;  ///< 'A' to 'G'
  std::uint8_t pin;
};

/// What the shared object tells of itself.
struct Image {
  const char* model;
  bool tm4c;
  unsigned inputs;  ///< channels that the model has
  unsigned outputs;
  std::array<PinPlace, 16> output_pins;
  std::array<PinPlace, 8> input_pins;
  PinPlace driver_enable;
  PinPlace init_switch;
  PinPlace status_led;
  unsigned uart;
  PinPlace receive;
  PinPlace transmit;

  /// Its RAM as after a reset.
  void (*clear)();
  /// Its `main`, which does not return.
  int (*run)();
  /// The handler of its vector table for an exception.
  void (*serve)(unsigned exception);

  [[nodiscard]] const Chip& chip() const { return tm4c ? kTm4c123 : kLm3s6965; }
  [[nodiscard]] std::string name() const { return std::string(chip().name) + "/" + model; }
};

/// Loads one; `path` of its shared object. Throws std::runtime_error. It stays loaded.
const Image& load_image(const std::string& path);

}  // namespace ex9000::registers
