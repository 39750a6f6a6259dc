// A firmware image that a host can run: the unchanged composition of a board, a model and the board's
// drivers. The bus accesses of the drivers go to registers::Microcontroller. Each image is a separate
// shared object, because EX9000_MODEL changes types of the firmware's core: for example, the frame buffers
// are smaller if the model does not speak Modbus.
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

/// The description of an image, which its shared object exports.
struct Image {
  const char* model;
  bool tm4c;
  unsigned inputs;  ///< channels of the model
  unsigned outputs;
  std::array<PinPlace, 16> output_pins;
  std::array<PinPlace, 8> input_pins;
  PinPlace driver_enable;
  PinPlace init_switch;
  PinPlace status_led;
  unsigned uart;
  PinPlace receive;
  PinPlace transmit;

  /// Constructs the image's `device` (boards/stellaris/composition.cpp) again, as after a reset.
  void (*clear)();
  /// Calls the image's `main`, which does not return.
  int (*run)();
  /// Calls the handler of `exception` in the image's vector table.
  void (*serve)(unsigned exception);

  [[nodiscard]] const Chip& chip() const { return tm4c ? kTm4c123 : kLm3s6965; }
  [[nodiscard]] std::string name() const { return std::string(chip().name) + "/" + model; }
};

/// Loads the shared object at `path`, which stays loaded. Throws std::runtime_error if the object cannot be
/// loaded or describes no image.
const Image& load_image(const std::string& path);

}  // namespace ex9000::registers
