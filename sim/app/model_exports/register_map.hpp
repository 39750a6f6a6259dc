// The Modbus map of a model: the content of the four tables of Modbus.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "firmware/model/model.hpp"
#include "firmware/registers/bits.hpp"
#include "firmware/registers/words.hpp"

namespace ex9000::sim {

enum class Table : std::uint8_t { Coils, DiscreteInputs, InputRegisters, HoldingRegisters };

/// One of the four tables of Modbus.
struct Area {
  Table table = Table::Coils;
  const char* name = "";  ///< name of one item of the table
  char digit = '0';       ///< first digit of the table's PLC numbers
  registers::Functions reads = 0;
  registers::Functions writes = 0;
};

constexpr std::array<Area, 4> kAreas{{
    {Table::Coils, "coil", '0', registers::kReadCoils,
     registers::kWriteSingleCoil | registers::kWriteMultipleCoils},
    {Table::DiscreteInputs, "discrete input", '1', registers::kReadDiscreteInputs, 0},
    {Table::InputRegisters, "input register", '3', registers::kReadInputRegisters, 0},
    {Table::HoldingRegisters, "holding register", '4', registers::kReadHoldingRegisters,
     registers::kWriteRegisters},
}};

/// One row of kBitRegisters or kWordRegisters, limited to one area. All texts live as long as the program.
struct MapRow {
  std::string_view id;
  const Area* area = nullptr;
  unsigned first = 0;                   ///< protocol address of the first item, from 0
  unsigned last = 0;                    ///< protocol address of the last item
  bool per_channel = false;             ///< one item for each input or output
  std::vector<std::uint8_t> functions;  ///< codes in ascending order; never empty
  bool reads = false;
  bool writes = false;
  std::string_view range;  ///< values that may be written; empty: read-only
  std::string_view meaning;
};

/// Returns the rows of coils first, then those of discrete inputs, input registers and holding registers.
/// Returns no rows if the model does not support Modbus.
std::vector<MapRow> register_map(const Model& model);

/// Returns the PLC number of the item with the protocol address `address`. PLC numbers count from 1 and have
/// at least four digits after the digit of the table.
std::string plc_number(const Area& area, unsigned address);

}  // namespace ex9000::sim
