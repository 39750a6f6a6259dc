// The state of a module, on which the outcome of a request depends.
#pragma once

#include <cstdint>

#include "firmware/channels/inputs.hpp"
#include "firmware/channels/output_timers.hpp"
#include "firmware/model/built.hpp"
#include "firmware/model/model.hpp"
#include "firmware/request/statistics.hpp"
#include "firmware/settings/settings.hpp"
#include "firmware/update/update.hpp"

namespace ex9000 {

/// From one reset to the next: values of the settings, or of INIT mode.
struct InForce {
  std::uint8_t address = 0;  ///< exception: outside INIT mode, `%` changes it when NN is stored
  std::uint8_t baud_code = kFactoryBaudCode;
  Protocol protocol = Protocol::Ascii;
  bool checksum = false;
  bool init_mode = false;
};

/// The synchronised sample of `#**` (manuals 2.2, 2.5).
struct Sample {
  bool taken = false;
  bool read = false;
  std::uint16_t outputs = 0;
  std::uint16_t inputs = 0;
};

/// What the main loop counts for registers/tallies.hpp; LineTallies has what interrupts count.
struct Diagnostics {
  std::uint16_t exceptions = 0;  ///< exception replies; in ASCII, replies that begin with `?`
  std::uint16_t no_responses = 0;
};

struct State {
  explicit constexpr State(const Model& model) : chosen(model) {}

  std::uint32_t board_serial_number = 0;  ///< 0: the board has none

  ChosenModel chosen;
  Settings settings;
  InForce in_force;
  bool init_asserted = false;  ///< whether INIT* is asserted now, debounced
  std::uint16_t outputs = 0;   ///< bit n is channel n, 1 = energised
  OutputTimers output_timers;
  Inputs inputs;
  Sample sample;
  bool reset_status = true;  ///< true until `$AA5` reads it
  Diagnostics diagnostics;
  Statistics statistics;
  update::Update update;
  ChosenVersion version;

  /// 0: the module has none.
  [[nodiscard]] std::uint32_t serial_number() const {
    return settings.serial_number != 0 ? settings.serial_number : board_serial_number;
  }
  [[nodiscard]] constexpr const Model& model() const { return chosen.get(); }
  [[nodiscard]] bool speaks_modbus() const {
    // not covered: kBuiltModbus is a constant
    return kBuiltModbus && in_force.protocol == Protocol::ModbusRtu;
  }
  /// wire.md section 2.
  [[nodiscard]] bool configuration_permitted() const { return in_force.init_mode || init_asserted; }
  /// Output commands are refused, wire.md section 6.
  [[nodiscard]] bool outputs_blocked() const { return settings.timeout_status; }
};

}  // namespace ex9000
