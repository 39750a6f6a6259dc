// The Modbus map of a model: what each of the four tables of Modbus holds.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/modbus/registers.hpp"
#include "firmware/model/model.hpp"

namespace ex9000::sim {

enum class Table : std::uint8_t { Coils, DiscreteInputs, InputRegisters, HoldingRegisters };

/// One of the four tables of Modbus.
struct Area {
  Table table = Table::Coils;
  const char* name = "";  ///< of one that it holds
  char digit = '0';       ///< in front of its PLC numbers
  modbus::Functions reads = 0;
  modbus::Functions writes = 0;
};

constexpr std::array<Area, 4> kAreas{{
    {Table::Coils, "coil", '0', modbus::kReadCoils, modbus::kWriteSingleCoil | modbus::kWriteMultipleCoils},
    {Table::DiscreteInputs, "discrete input", '1', modbus::kReadDiscreteInputs, 0},
    {Table::InputRegisters, "input register", '3', modbus::kReadInputRegisters, 0},
    {Table::HoldingRegisters, "holding register", '4', modbus::kReadHoldingRegisters,
     modbus::kWriteRegisters},
}};

/// One row of the firmware's tables, as far as it lies in one area. All texts live as long as the program.
struct MapRow {
  std::string_view id;
  const Area* area = nullptr;
  unsigned first = 0;               ///< address of the first, from 0 as on the line
  unsigned last = 0;                ///< likewise
  bool per_channel = false;         ///< one for each input or output
  std::vector<unsigned> functions;  ///< codes, in rising order; never empty
  bool reads = false;
  bool writes = false;
  std::string_view range;  ///< of what may be written; empty where nothing may
  std::string_view meaning;
};

/// Coils first, then discrete inputs, input registers and holding registers. Empty where the model speaks no
/// Modbus.
std::vector<MapRow> register_map(const Model& model);

/// As PLCs count: from 1, in at least four digits behind that of the table.
std::string plc_number(const Area& area, unsigned address);

/// Function codes as two hex digits each.
std::string hex_codes(const std::vector<unsigned>& functions, const char* separator);

}  // namespace ex9000::sim
