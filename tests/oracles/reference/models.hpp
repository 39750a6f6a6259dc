// The table of models of the reference: wire.md 1. It is independent of the firmware's table, so that the
// tests find a mistake in either table.
#pragma once

#include <cstdint>

namespace ex9000::reference {

/// One row of the table of models.
struct ModelRow {
  const char* designation;
  unsigned inputs;
  unsigned outputs;
  bool both_protocols;    ///< the -M models: Modbus RTU and ASCII
  bool status_80_84;      ///< `~AA0` returns 00, 80 or 84; if false, 00 or 04
  const char* name;       ///< factory name, as `$AAM` reads it
  unsigned longest_name;  ///< greatest length of a name that `~AAO(Data)` stores
  std::uint16_t code;     ///< Modbus module code; 0 without Modbus
  const char* in_words;   ///< object 04 of function 2B
};

constexpr ModelRow kModelRows[] = {
    {"EX9042D", 0, 13, false, true, "9042D", 6, 0, "13 open-collector outputs"},
    {"EX9042D-M", 0, 13, true, true, "9042M", 6, 0x9042, "13 open-collector outputs"},
    {"EX9043D", 0, 16, false, false, "9043D", 6, 0, "16 open-collector outputs"},
    {"EX9043D-M", 0, 16, true, false, "9043M", 6, 0x9043, "16 open-collector outputs"},
    {"EX9052D", 8, 0, false, true, "9052", 6, 0, "8 inputs with latches and counters"},
    {"EX9052D-M", 8, 0, true, true, "9052M", 6, 0x9052, "8 inputs with latches and counters"},
    {"EX9068D-M", 0, 8, true, false, "9068D-M", 7, 0x9068, "8 relay outputs"},
    {"EX9068AD-M", 0, 8, true, false, "9068D-M", 7, 0x9068, "8 PhotoMOS outputs"},
    {"EX9044D", 4, 8, false, false, "9044", 6, 0, ""},
    {"EX9044D-M", 4, 8, true, false, "9044M", 6, 0x9044, "4 inputs, 8 open-collector outputs"},
    {"EX9050D", 7, 8, false, false, "9050", 6, 0, ""},
    {"EX9053D", 16, 0, false, true, "9053", 6, 0, ""},
    {"EX9053D-M", 16, 0, true, true, "9053M", 6, 0x9053, "16 inputs with latches and counters"},
    {"EX9055D", 8, 8, false, false, "9055", 6, 0, ""},
    {"EX9060D", 4, 4, false, false, "9060", 6, 0, ""},
    {"EX9060D-M", 4, 4, true, false, "9060M", 6, 0x9060, "4 inputs, 4 relay outputs"},
    {"EX9063D", 8, 3, false, false, "9063", 6, 0, ""},
    {"EX9065D", 4, 5, false, false, "9065", 6, 0, ""},
    {"EX9066D", 0, 7, false, false, "9066", 6, 0, ""},
    {"EX9067D", 0, 7, false, false, "9067", 6, 0, ""},
    {"EX9068D", 0, 8, false, false, "9068", 6, 0, ""},
};

}  // namespace ex9000::reference
