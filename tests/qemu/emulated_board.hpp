// The board of a module: the microcontroller with its image, the EEPROM and the pins.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "hal/serial_mode.hpp"
#include "tests/qemu/emulator.hpp"
#include "tests/support/directory.hpp"

namespace ex9000::rig {

/// The supply is off at first. The functions that access the emulator throw std::runtime_error if it fails.
class EmulatedBoard {
 public:
  EmulatedBoard(const EmulatedBoard&) = delete;
  EmulatedBoard& operator=(const EmulatedBoard&) = delete;

  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] bool powered() const { return powered_; }
  /// Connects INIT* to GND if `asserted` is true; otherwise disconnects INIT*.
  void set_init(bool asserted);

  /// Returns the output levels. Bit n is channel n. The levels are 0 if the supply is off.
  [[nodiscard]] std::uint16_t outputs();
  [[nodiscard]] bool led_lit();
  /// Returns the baud rate and the line format that the image has selected in the registers of the UART. The
  /// rate is 0 if the supply or the UART is off, or if the divisor is 0. In all other cases, throws
  /// std::runtime_error if the format is not one that modules have, or if the FIFOs are on.
  [[nodiscard]] hal::SerialMode mode();

  /// Returns the emulator. Call this only while the board is powered.
  Emulator& emulator() { return *emulator_; }
  /// Sets the content of the EEPROM's file.
  void set_memory(const std::string& bytes) { system::write_file(directory_ / "memory", bytes); }

 protected:
  /// Stores `settings` in the EEPROM. If the pointer is null or the settings are the factory settings, erases
  /// the EEPROM instead. With an erased EEPROM, the module uses the factory settings.
  EmulatedBoard(const Model& model, const Settings* settings);
  ~EmulatedBoard() = default;

  /// Switches the supply. When the supply goes on, the machine is halted before its first instruction, and
  /// each byte of RAM is 0xA5. The start of an emulator takes most of the time of a short test. Therefore
  /// this function resets an existing emulator. The existing emulator must be halted before the call. The
  /// reset makes the emulator read the EEPROM's file again.
  void supply(bool on);
  /// Switches the supply off and kills the emulator with SIGKILL. The next `supply(true)` starts a new
  /// emulator.
  void kill();
  /// Resets the machine with the reset pin. The machine must be halted and stays halted. Discards the bytes
  /// from UART0 that have not been read.
  void pull_reset();
  /// Makes the board like a new one whose supply has just gone on: INIT* is disconnected, inputs are off, and
  /// the EEPROM contains `settings` (see the constructor).
  void renew(const Settings* settings);
  /// Sets the level of an input channel. The model must have that channel.
  void set_level(unsigned channel, bool level);
  [[nodiscard]] bool level(unsigned channel) const { return levels_.at(channel); }

 private:
  void store(const Settings* settings);
  void fill_ram();
  void set_pin_levels();

  const Model& model_;
  system::Directory directory_;
  std::optional<Emulator> emulator_;
  bool powered_ = false;
  bool init_asserted_ = false;
  std::array<bool, kMaxInputs> levels_{};
};

/// Returns the path of the ELF file of this model.
std::string image_of(const Model& model);

}  // namespace ex9000::rig
