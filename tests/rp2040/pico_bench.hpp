// An image on an emulated Pico with transceiver, EEPROM and pins, in virtual time.
#pragma once

#include <chrono>
#include <cstdint>
#include <map>
#include <string>

#include "boards/rp2040/memory.hpp"
#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "sim/app/play/transcript.hpp"
#include "tests/rp2040/emulator_process.hpp"

namespace ex9000::pico {

using board::Memory;

/// The longest time from a reset until a module is ready to receive requests (wire.md section 2).
constexpr std::chrono::milliseconds kComingUp{100};

/// A function that sends a command to the emulator throws std::runtime_error if the command fails, for
/// example because the image does something that is an error on a real chip.
class PicoBench {
 public:
  /// `memory` is the memory in which the images of this board store their settings.
  explicit PicoBench(Memory memory = Memory::Flash) : memory_(memory) {}

  /// Provides a new board with the image of `model`. Its supply is off. Its memory holds `settings`, or no
  /// settings if `settings` is null. If the memory is in the flash, each sector without settings is marked as
  /// erased.
  void begin_anew(const Model& model, const Settings* settings);
  /// Provides a new board in the same way, but with `memory` as the content of its memory. `memory` is the
  /// content of an EEPROM, or is empty. If `memory` is empty, the board has no stored settings.
  void begin_anew(const Model& model, const play::Bytes& memory);
  /// Removes the marks of erased sectors from all sectors except the first, which contains the settings.
  /// After the next start, the log in the flash erases these sectors, as after the first start of a module.
  /// Call `begin_anew` with settings before you call this function.
  void forget_erased_sectors();
  /// Fills the log in the flash: all sectors are full of records with these settings. Call `begin_anew`
  /// first.
  void fill_log(const Settings& settings);
  /// Provides a new board. Its flash begins with the content of `file`, its EEPROM is erased, and its supply
  /// is off.
  void begin_with(const std::string& file);

  void power(bool on);
  [[nodiscard]] bool powered() const { return powered_; }
  /// Resets the chip with its RUN pin.
  void reset();
  /// Lets `kComingUp` pass. The byte 00 that an automatic transceiver makes of the floating transmit pin does
  /// not arrive.
  void come_up();
  void run_for(std::chrono::nanoseconds time);
  /// Returns the virtual time since `begin_anew` or `begin_with`.
  std::chrono::nanoseconds now();

  /// Sets the baud rate of the master, which is 9600 on a new board.
  void set_baud(std::uint32_t rate);
  /// Sets the line format of the master, which is 8N1 on a new board.
  void set_format(LineFormat format);
  /// Sends bytes without a gap. Returns when the last stop bit has ended.
  void send(const play::Bytes& bytes);
  /// Returns up to `count` bytes that have arrived and that no earlier call has returned. First lets time
  /// pass until there are `count` such bytes, or until no byte has arrived for `patience`.
  play::Bytes receive(std::size_t count, std::chrono::nanoseconds patience);
  /// Returns the bytes that have arrived and that no earlier call has returned.
  play::Bytes heard();

  void set_init(bool asserted);
  /// Drives an input. Until the first call for a channel of a new board, the input is open.
  void set_input(unsigned channel, bool level);
  /// Makes `count` pulses on an input. Each pulse has two edges: the first inverts the level, and the
  /// second restores it. After each edge, the time `between` passes.
  void pulse_input(unsigned channel, std::uint32_t count, std::chrono::nanoseconds between);
  /// Returns the energised channels: bit n is channel n. Returns 0 while the supply is off.
  std::uint16_t outputs();
  bool led();
  /// Returns the levels of all pins. Bit n is GPIOn.
  std::uint32_t levels();
  /// Lets time pass until the LED changes, but at most `patience`. Returns whether it has changed.
  bool led_changes(std::chrono::nanoseconds patience);

  /// Returns the event counts since `begin_anew` or `begin_with`, and other values, by name; see the command
  /// `counts` in emulator.js.
  std::map<std::string, long> counts();
  std::string execute(const std::string& command) { return emulator_.execute(command); }

 private:
  void set_pin(unsigned number, const char* level);
  /// Sets the first bytes of a sector of the log to `bytes`.
  void set_sector(unsigned sector, const play::Bytes& bytes);

  Memory memory_;
  EmulatorProcess emulator_;
  const Model* model_ = nullptr;
  bool powered_ = false;
};

/// Returns the path of the image of a model. The file contains the content of the flash.
std::string image_of(const Model& model, Memory memory);

}  // namespace ex9000::pico
