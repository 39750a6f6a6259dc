// An image that stores, the contents of its EEPROM at every point at which the power may fail meanwhile, and
// what it comes up with from them.
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

/// What the EEPROM holds where settings may lie; the rest of it is blank.
using Contents = std::array<std::uint8_t, kStoredMemory>;

/// What power cuts in the course of one command leave.
struct Cuts {
  std::size_t points = 0;  ///< on the bus, and within each byte that is programmed
  std::size_t cuts = 0;    ///< points, by what they may do to the page
  /// Each of the contents that are left, once. True: of at least one of these cuts it is certain that the
  /// command is done, for the reply to it had begun, or because it is long over where it has none.
  std::map<Contents, bool> left;
  std::uint16_t outputs = 0;    ///< before the command
  std::vector<Instant> events;  ///< on the EEPROM's bus, behind the begin of the command
};

/// What has been seen at the pins of the outputs since a reset.
struct Outputs {
  std::uint16_t now = 0;
  std::uint16_t ever_on = 0;
  unsigned changes = 0;  ///< of any of them
};

/// As a master finds a module that has come up.
struct Found {
  std::optional<Settings> settings;  ///< none: it does not answer
  Outputs outputs;                   ///< before the first request
};

/// A module whose microcontroller alone began anew in the middle of a command.
struct AfterReset {
  Contents contents;
  bool certainly_done;  ///< as in Cuts::left
  Outputs outputs;
};

/// What a worn-out memory makes of a command.
struct Attempt {
  std::vector<std::uint8_t> reply;
  Instant reply_after{0};  ///< from the end of the request to the driver; up to 0.1 ms less than it was
  unsigned spoiled = 0;    ///< bytes that the memory has kept otherwise than it was told
  unsigned tries = 0;      ///< whole copies that were programmed
  std::vector<Contents> meanwhile;  ///< until the reply began, or the last page that was programmed was
  std::vector<Contents> behind;     ///< from then on, for more than a second
  std::uint16_t outputs_before = 0;
  std::uint16_t outputs = 0;  ///< in the end
};

class CutBench {
 public:
  CutBench(const Image& image, const Model& model);

  /// The command carried out on a module that comes up with `contents`, which are `before`. That it is
  /// answered as it should be, and drives what it should when it should, is expected by the way.
  Cuts cut_everywhere(const Contents& contents, const Settings& before, const StoringCommand& command);

  /// The same, but for a reset of the microcontroller so long behind the begin of the command, while the
  /// EEPROM keeps its supply. As it is once the module is up again.
  AfterReset reset_after(Instant time, const Contents& contents, const Settings& before,
                         const StoringCommand& command);

  /// The command sent to a module that comes up with `contents`, which are `before`, and whose memory is worn
  /// out then: from the place on, with these bits stuck.
  Attempt attempt(const Contents& contents, const Settings& before, const StoringCommand& command,
                  std::uint16_t place, std::uint8_t bits, std::uint8_t stuck);

  /// Of a page, from now on: 10 ms at most, as the AT24C64's data sheet says.
  void set_programming_time(Instant time) { bench_.eeprom.set_programming_time(time); }

  /// The outputs from which such a command begins.
  [[nodiscard]] std::uint16_t outputs_before(const Settings& settings) const;

  /// Comes up with `contents`, and is asked for all its settings in the protocol, at the rate and the address
  /// of the first of `guesses` at which it answers. What Modbus does not tell, the data format, is asked for
  /// in INIT mode where `thoroughly`, and otherwise is the guess's.
  Found come_up(const Contents& contents, const std::vector<Settings>& guesses, bool thoroughly);

 private:
  using Bytes = std::vector<std::uint8_t>;

  void power_up(const Contents& contents, bool init);
  UartPort& uart() { return bench_.image.uart == 0 ? bench_.mcu->uart0 : bench_.mcu->uart1; }
  [[nodiscard]] Contents contents() const;
  [[nodiscard]] bool holds_what_must_not_count(const Contents& contents) const;
  [[nodiscard]] std::size_t pages_of_a_store(const Contents& contents) const;
  Outputs outputs();
  void note_cuts(Cuts& cuts);
  Manner speak_as(const Settings& settings, bool init_mode);
  void send(const Bytes& frame);
  Bytes hear();
  SettingsReader master(const Manner& manner);
  void set_outputs(const Manner& manner);
  Manner get_ready(const Contents& contents, const Settings& before, const StoringCommand& command);
  void carry_out(const Manner& manner, const StoringCommand& command, const Settings& before,
                 std::size_t pages);

  const Model& model_;
  Outputs shown_;  ///< but for what is so now; outlives the board
  BoardBench bench_;
};

}  // namespace ex9000::registers
