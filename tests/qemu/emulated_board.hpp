// A module's board: microcontroller with its image, EEPROM and pins.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "tests/qemu/emulator.hpp"
#include "tests/support/directory.hpp"

namespace ex9000::rig {

/// With the supply off at first. Calls throw std::runtime_error where the emulator fails.
class EmulatedBoard {
 public:
  EmulatedBoard(const EmulatedBoard&) = delete;
  EmulatedBoard& operator=(const EmulatedBoard&) = delete;

  [[nodiscard]] const Model& model() const { return model_; }
  [[nodiscard]] bool powered() const { return powered_; }
  /// INIT* tied to GND, or released.
  void set_init(bool asserted);

  /// Bit n is channel n.
  [[nodiscard]] std::uint16_t outputs();
  [[nodiscard]] bool led_lit();
  /// Bits per second of the UART as the image has set it up; 0 where it is off.
  [[nodiscard]] std::uint32_t baud();

  /// Only while powered.
  Emulator& emulator() { return *emulator_; }
  /// What the EEPROM holds; its file.
  [[nodiscard]] std::string memory() const { return system::bytes_of_file(directory_ / "memory"); }
  void set_memory(const std::string& bytes) { system::write_file(directory_ / "memory", bytes); }

 protected:
  /// The EEPROM holds `settings`, or nothing where they are null.
  EmulatedBoard(const Model& model, const Settings* settings);
  ~EmulatedBoard() = default;

  /// When it comes on the machine is halted before its first instruction, and nothing but the EEPROM is left
  /// of what was. Making an emulator takes most of the time of a short test, so the same one comes on again:
  /// halted and reset, by which it reads the EEPROM's file again, with noise in RAM.
  void supply(bool on);
  /// Off as by SIGKILL: the next `supply` makes another emulator.
  void kill();
  /// By the reset pin, while halted; it stays halted.
  void pull_reset();
  /// Another board with supply just on: INIT* released, inputs off, the EEPROM as the constructor has it.
  void renew(const Settings* settings);
  /// Level of an input channel that the model has.
  void set_level(unsigned channel, bool level);
  [[nodiscard]] bool level(unsigned channel) const { return levels_.at(channel); }

 private:
  void store(const Settings* settings);
  void fill_ram();
  void give_levels();

  const Model& model_;
  system::Directory directory_;
  std::optional<Emulator> emulator_;
  bool powered_ = false;
  bool init_asserted_ = false;
  std::array<bool, kMaxInputs> levels_{};
};

/// The ELF file of this model.
std::string image_of(const Model& model);

}  // namespace ex9000::rig
