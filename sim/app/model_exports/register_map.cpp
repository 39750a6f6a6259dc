#include "sim/app/model_exports/register_map.hpp"

namespace ex9000::sim {

namespace {

std::vector<std::uint8_t> function_codes(registers::Functions functions) {
  std::vector<std::uint8_t> codes;
  for (std::uint8_t function = 0; function < 16; ++function) {
    if ((functions >> function & 1U) != 0) {
      codes.push_back(function);
    }
  }
  if ((functions & registers::kWriteRegisters) != 0) {
    codes.push_back(0x10);
  }
  return codes;
}

template <class Register>
void add_row(const Model& model, const Area& area, const Register& entry, std::vector<MapRow>& map) {
  const auto& row = entry.row;
  // Only the row of host OK lists no functions, because the firmware detects a host OK without
  // kWordRegisters. Masters send a host OK with function 03 or 04.
  const registers::Functions functions = row.functions != 0 ? row.functions : registers::kReadRegisters;
  const bool reads = (functions & area.reads) != 0;
  const bool writes = (functions & area.writes) != 0;
  if (!meets(model, row.needs) || (!reads && !writes)) {
    return;
  }
  const unsigned last = row.first + registers::width_of(row.width, model) - 1;
  map.push_back({entry.id, &area, row.first, last,
                 row.width == registers::Width::PerOutput || row.width == registers::Width::PerInput,
                 function_codes(functions & (area.reads | area.writes)), reads, writes,
                 writes ? entry.range : std::string_view(), entry.meaning});
}

}  // namespace

std::vector<MapRow> register_map(const Model& model) {
  std::vector<MapRow> map;
  if (!model.speaks_modbus()) {
    return map;
  }
  for (const Area& area : kAreas) {
    for (const registers::BitRegister& entry : registers::kBitRegisters) {
      add_row(model, area, entry, map);
    }
    for (const registers::WordRegister& entry : registers::kWordRegisters) {
      add_row(model, area, entry, map);
    }
  }
  return map;
}

std::string plc_number(const Area& area, unsigned address) {
  constexpr std::size_t kDigits = 4;
  const std::string number = std::to_string(address + 1);
  return area.digit + std::string(number.size() < kDigits ? kDigits - number.size() : 0, '0') + number;
}

}  // namespace ex9000::sim
