// The table of extension registers of the reference: extensions.md.
#pragma once

#include <vector>

#include "tests/oracles/reference/models.hpp"
#include "tests/oracles/reference/module.hpp"

namespace ex9000::reference {

/// The kinds of extension registers.
enum class Extension {
  InputFilters,
  Inversion,
  Setting,  ///< a stored number without another effect when it is written
  SerialNumber,
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
  Extension row = Extension::None;
  const char* name = "";
  unsigned first = 0;
  unsigned count = 0;    ///< of 16-bit registers
  bool written = false;  ///< the registers can also be written
  bool wide = false;     ///< values of 32 bits, each in two registers
  unsigned highest = 0;  ///< of the values that can be written
  unsigned Stored::*setting = nullptr;
  bool permission = false;  ///< a write requires the configuration permission
};

/// Returns the table for a model. A row without registers has the count 0.
std::vector<ExtensionRow> extension_rows(const ModelRow& model);

/// Returns the row of the table that contains this register. Returns a row with Extension::None if the model
/// has no such register.
ExtensionRow extension_row(const ModelRow& model, unsigned address);

}  // namespace ex9000::reference
