// Runs an image that stores settings, and collects the contents that a power cut at any time may leave in the
// EEPROM. Also starts the image from such contents and reads the settings of the module, resets the
// microcontroller during a command, and sends commands to a module with a worn-out EEPROM.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "tests/mcu_model/board_bench.hpp"
#include "tests/oracles/stored_copy.hpp"
#include "tests/support/settings_reader.hpp"
#include "tests/support/storing_commands.hpp"

namespace ex9000::registers {

/// The contents of the EEPROM at the addresses that settings may use. The other addresses are blank.
using Contents = std::array<std::uint8_t, kStoredMemory>;

/// The results of power cuts during one command, or while the module finishes an update.
struct Cuts {
  /// The number of points at which the power was cut. Each event of the EEPROM (EepromChip::on_event) is one
  /// point. If a page is being programmed at the event, each byte that is being programmed is a point
  /// instead. The end of a command is also a point.
  std::size_t points = 0;
  std::size_t cuts = 0;  ///< each point counts once for each effect that a cut may have on the EEPROM
  /// The keys are the different contents that the cuts left. The value is true if the command was certainly
  /// done at one or more of the cuts that left these contents: the reply had begun, or the command had ended.
  std::map<Contents, bool> left;
  std::uint16_t outputs = 0;    ///< before the command
  std::vector<Instant> events;  ///< times of the EEPROM's events, from the beginning of the command
};

/// The levels seen at the output pins since a reset.
struct Outputs {
  std::uint16_t now = 0;
  std::uint16_t ever_on = 0;
  unsigned changes = 0;  ///< number of changes of all outputs together
};

/// The state that a master finds when a module has started.
struct Found {
  std::optional<Settings> settings;  ///< no value: no guess got a reply of the right length
  Outputs outputs;                   ///< before the first request
};

/// A module that has restarted after a reset of its microcontroller during a command. The EEPROM kept its
/// supply.
struct AfterReset {
  Contents contents;
  bool certainly_done;  ///< the reply had begun before the reset
  Outputs outputs;
};

/// The results of a command, or of a timeout of the host watchdog, on a worn-out memory.
struct Attempt {
  std::vector<std::uint8_t> reply;
  /// The time from the end of the request until the driver is on. The value can be up to 0.1 ms too small. It
  /// is kNever if an expected reply is missing, and 0 if no reply is expected.
  Instant reply_after{0};
  // `spoiled` and `tries` count until 600 ms after the end of the request. For a timeout of the host
  // watchdog, they count for 600 ms, during which the timeout occurs.
  unsigned spoiled = 0;  ///< number of times that the worn-out byte did not take its new value
  unsigned tries = 0;    ///< number of page writes of at least 20 bytes
  /// The contents at each event of the EEPROM before the reply begins. If there is no reply, the contents at
  /// each event.
  std::vector<Contents> meanwhile;
  /// The contents at each event of the EEPROM after the reply has begun, and the contents at the end. The end
  /// is more than 1 s after the beginning of the reply.
  std::vector<Contents> behind;
  std::uint16_t outputs_before = 0;
  std::uint16_t outputs = 0;  ///< at the end
};

class CutBench {
 public:
  CutBench(const Image& image, const Model& model);

  /// Starts a module with `contents`. The settings of this module are then `before`. Sends the command, or
  /// waits until the host watchdog expires. Returns the results of power cuts at all points of the command.
  /// Also checks that the module accepts the command and changes the outputs at the correct time.
  Cuts cut_everywhere(const Contents& contents, const Settings& before, const StoringCommand& command);

  /// Starts a module with `contents`. The settings of this module are then `before`. Sends the command, or
  /// waits until the host watchdog expires. Resets the microcontroller at `time` after the beginning of the
  /// command, while the EEPROM keeps its supply. Returns the state after the restart.
  AfterReset reset_after(Instant time, const Contents& contents, const Settings& before,
                         const StoringCommand& command);

  /// Starts a module with `contents`. The settings of this module are then `before`. Then wears out a byte of
  /// the memory: from the next write of the byte at `place` on, the bits `bits` of this byte have the values
  /// that they have in `stuck`. Then sends the command, or waits until the host watchdog expires.
  Attempt attempt(const Contents& contents, const Settings& before, const StoringCommand& command,
                  std::uint16_t place, std::uint8_t bits, std::uint8_t stuck);

  /// Sets the programming time of a page: at most 10 ms according to the AT24C64's data sheet.
  void set_programming_time(Instant time) { bench_.eeprom.set_programming_time(time); }

  /// Returns the outputs that a module with these settings has when the command arrives.
  [[nodiscard]] std::uint16_t outputs_before(const Settings& settings) const;

  /// Starts the module with `contents` and reads all its settings. For that, uses the protocol, address,
  /// checksum, baud rate and line format of the first of `guesses` to which the module replies. No Modbus
  /// register contains the whole data format. If `thoroughly` is true, first starts the module in INIT mode
  /// and reads the data format there; otherwise, if the module uses Modbus, takes the data format from the
  /// guess. Also checks that reading changes no output, and that the module writes nothing to the EEPROM.
  Found come_up(const Contents& contents, const std::vector<Settings>& guesses, bool thoroughly);

 private:
  using Bytes = std::vector<std::uint8_t>;

  void power_up(const Contents& contents, bool init);
  UartPort& uart() { return bench_.image.uart == 0 ? bench_.mcu->uart0 : bench_.mcu->uart1; }
  [[nodiscard]] Contents contents() const;
  [[nodiscard]] std::size_t pages_of_a_store(const Contents& contents, const Settings& settings) const;
  Outputs outputs();
  void note_cuts(Cuts& cuts);
  FrameFormat speak_as(const Settings& settings, bool init_mode);
  void send(const Bytes& frame);
  Bytes hear();
  SettingsReader master(const FrameFormat& frame_format);
  void set_outputs(const FrameFormat& frame_format);
  FrameFormat get_ready(const Contents& contents, const Settings& before, const StoringCommand& command);
  void carry_out(const FrameFormat& frame_format, const StoringCommand& command, const Settings& before,
                 std::size_t pages);

  const Model& model_;
  /// The member `now` of this variable is not used. The variable is declared before `bench_` because
  /// callbacks of `bench_` write to it.
  Outputs shown_;
  BoardBench bench_;
};

}  // namespace ex9000::registers
