// Runs an image that stores settings, and collects the contents of its EEPROM at every point at which the
// power may fail. Also starts the image from such contents and reads its settings.
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

/// The contents of the EEPROM at the addresses that settings may use; the rest is blank.
using Contents = std::array<std::uint8_t, kStoredMemory>;

/// The results of power cuts during one command.
struct Cuts {
  std::size_t points = 0;  ///< of cuts: each event on the bus, and each byte that is being programmed
  std::size_t cuts = 0;    ///< each point counts once for each effect that a cut may have on the page
  /// Each of the resulting contents, once. The value is true if the command was certainly done after at least
  /// one of these cuts, because the reply had begun, or because enough time had passed for a command without
  /// a reply.
  std::map<Contents, bool> left;
  std::uint16_t outputs = 0;    ///< before the command
  std::vector<Instant> events;  ///< times of events on the EEPROM's bus, from the beginning of the command
};

/// The levels seen at the output pins since a reset.
struct Outputs {
  std::uint16_t now = 0;
  std::uint16_t ever_on = 0;
  unsigned changes = 0;  ///< of any output
};

/// The state that a master finds when a module has started.
struct Found {
  std::optional<Settings> settings;  ///< no value: the module does not reply
  Outputs outputs;                   ///< before the first request
};

/// A module whose microcontroller was reset in the middle of a command while the EEPROM kept its supply.
struct AfterReset {
  Contents contents;
  bool certainly_done;  ///< as in Cuts::left
  Outputs outputs;
};

/// The results of a command on a worn-out memory.
struct Attempt {
  std::vector<std::uint8_t> reply;
  Instant reply_after{0};  ///< from the end of the request until the driver is on; up to 0.1 ms too short
  unsigned spoiled = 0;    ///< bytes that the memory has stored incorrectly
  unsigned tries = 0;      ///< number of pages that were programmed with at least 20 bytes
  std::vector<Contents> meanwhile;  ///< at each event before the reply; without a reply, at each event
  std::vector<Contents>
      behind;  ///< at each event from the reply until more than a second later, and at the end
  std::uint16_t outputs_before = 0;
  std::uint16_t outputs = 0;  ///< at the end
};

class CutBench {
 public:
  CutBench(const Image& image, const Model& model);

  /// Executes the command on a module that starts with `contents`, which store `before`. Also checks that the
  /// module replies correctly and drives the correct outputs at the correct time.
  Cuts cut_everywhere(const Contents& contents, const Settings& before, const StoringCommand& command);

  /// Starts a module with `contents`, which store `before`, and sends the command. Resets the microcontroller
  /// at `time` after the beginning of the command, while the EEPROM keeps its supply. Returns the state after
  /// the restart.
  AfterReset reset_after(Instant time, const Contents& contents, const Settings& before,
                         const StoringCommand& command);

  /// Starts a module with `contents`, which a cut during the first store after an update has left, and lets
  /// it finish the update. Returns no cuts if the update is already complete.
  Cuts cut_while_finishing_update(const Contents& contents);

  /// Starts a module with `contents`, which store `before`. Then wears out its memory: the bits `bits` of the
  /// byte at `place` keep the value `stuck`. Then sends the command.
  Attempt attempt(const Contents& contents, const Settings& before, const StoringCommand& command,
                  std::uint16_t place, std::uint8_t bits, std::uint8_t stuck);

  /// Sets the programming time of a page: at most 10 ms according to the AT24C64's data sheet.
  void set_programming_time(Instant time) { bench_.eeprom.set_programming_time(time); }

  /// Returns the outputs before a command that is executed with these settings.
  [[nodiscard]] std::uint16_t outputs_before(const Settings& settings) const;

  /// Starts the module with `contents` and reads all its settings with the protocol, baud rate and address of
  /// the first of `guesses` to which the module replies. Modbus has no register for the data format. If
  /// `thoroughly` is true, reads the format in INIT mode; otherwise uses the format of the guess.
  Found come_up(const Contents& contents, const std::vector<Settings>& guesses, bool thoroughly);

 private:
  using Bytes = std::vector<std::uint8_t>;

  void power_up(const Contents& contents, bool init);
  UartPort& uart() { return bench_.image.uart == 0 ? bench_.mcu->uart0 : bench_.mcu->uart1; }
  [[nodiscard]] Contents contents() const;
  [[nodiscard]] bool has_unfinished_update(const Contents& contents) const;
  [[nodiscard]] std::size_t pages_of_a_store(const Contents& contents, const Settings& settings) const;
  Outputs outputs();
  void finish_update();
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
  /// Does not include the present levels. Declared before `bench_` because it must outlive `bench_`.
  Outputs shown_;
  BoardBench bench_;
};

}  // namespace ex9000::registers
