// The table of extension registers of the reference: extensions.md.
#pragma once

#include "tests/oracles/reference/models.hpp"

namespace ex9000::reference {

/// The kinds of extension registers: the rows of the table.
enum class Extension {
  InputFilters,
  Inversion,
  RestartedBy,
  ResponseDelay,
  WideCounters,
  TimedOutputs,
  Version,
  ResetReason,
  Uptime,
  Timeouts,
  Stores,
  SettingsSource,
  Tallies,
  None,
};

struct ExtensionRow {
  Extension row;
  const char* name;
  unsigned first;
  unsigned count;  ///< of 16-bit registers
  bool written;    ///< the registers can also be written
  bool wide;       ///< values of 32 bits, each in two registers
};

/// Returns the row of the table that contains this register. Returns a row with Extension::None if the model
/// has no such register.
ExtensionRow extension_row(const ModelRow& model, unsigned address);

}  // namespace ex9000::reference
