// A module: image, board and EEPROM, with what can be done to a real one from outside.
#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "tests/rig/emulator.hpp"
#include "tests/system/directory.hpp"

namespace ex9000::rig {

/// With the supply off at first. Calls throw std::runtime_error where the emulator fails.
class EmulatedModule {
 public:
  /// The EEPROM holds `settings`, or nothing where they are null.
  EmulatedModule(const Model& model, const Settings* settings);

  /// A module of which nothing is left of what was: INIT* released, inputs off, the EEPROM as the constructor
  /// has it, supply on. Where it is on already this saves making an emulator: the EEPROM's file is read again
  /// at a reset, and RAM is filled with what no image has left there.
  void begin_anew(const Settings* settings);
  /// The supply. Whenever it comes on, it is a new emulator's, to which nothing but the EEPROM is left of
  /// what was; off is as sudden as SIGKILL.
  void power(bool on);
  [[nodiscard]] bool powered() const { return emulator_.has_value(); }
  /// By the reset pin; none without power.
  void reset();
  /// Whether the image is about to be reset by its watchdog (`WATCHDOG`) or by itself (`SHUTDOWN`); waits 10
  /// s.
  bool halts_because(const std::string& event);
  /// That reset.
  void come_up_again();
  /// INIT* tied to GND, or released.
  void set_init(bool asserted);
  /// Level of an input channel; channels the model lacks may be set and do nothing. Returns when the image
  /// has seen the edge.
  void set_input(unsigned channel, bool level);
  /// `count` full pulses from the present level and back, as fast as the image takes them.
  void pulse_input(unsigned channel, std::uint32_t count);

  /// Bit n is channel n.
  [[nodiscard]] std::uint16_t outputs();
  [[nodiscard]] bool led_lit();
  /// Bits per second of the UART as the image has set it up; 0 where it is off.
  [[nodiscard]] std::uint32_t baud();

  /// The image's own clock: time since it has started it, in whole ticks; 0 without power. Under a host that
  /// is busy it is behind, and all that the image measures is.
  [[nodiscard]] std::chrono::microseconds time();

  /// Bytes on the line at the module's own rate.
  void send(const std::vector<std::uint8_t>& bytes);
  /// What the module has sent, once there is something; nothing where nothing came for `patience`.
  std::vector<std::uint8_t> hear(std::chrono::nanoseconds patience);

  [[nodiscard]] const Model& model() const { return model_; }
  /// Only while powered.
  Emulator& emulator() { return *emulator_; }
  /// What the EEPROM holds; its file.
  [[nodiscard]] std::string memory() const { return system::bytes_of_file(directory_ / "memory"); }
  void set_memory(const std::string& bytes) { system::write_file(directory_ / "memory", bytes); }

 private:
  void store(const Settings* settings);
  void give_levels();

  const Model& model_;
  system::Directory directory_;
  std::optional<Emulator> emulator_;
  bool init_asserted_ = false;
  std::array<bool, kMaxInputs> levels_{};
};

/// The ELF file of this model.
std::string image_of(const Model& model);

}  // namespace ex9000::rig
