// The table of extension registers of the reference: wire.md, extensions.
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

/// Looks up a register in the table for this model. Rows of length 0 do not exist on the model.
ExtensionRow extension_row(const ModelRow& model, unsigned address);

}  // namespace ex9000::reference
