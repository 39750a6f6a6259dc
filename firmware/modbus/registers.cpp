#include "firmware/modbus/registers.hpp"

namespace ex9000::modbus {

namespace {

// The rows without their texts.
constexpr auto kBitRows = [] {
  std::array<BitRow, kBitRegisters.size()> rows{};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i] = kBitRegisters[i].row;
  }
  return rows;
}();

constexpr auto kWordRows = [] {
  std::array<WordRow, kWordRegisters.size()> rows{};
  for (std::size_t i = 0; i < rows.size(); ++i) {
    rows[i] = kWordRegisters[i].row;
  }
  return rows;
}();

template <class Rows>
auto find_in(const Rows& rows, const Model& model, Functions function, std::uint16_t address)
    -> decltype(&rows[0]) {
  for (const auto& row : rows) {
    const unsigned index = unsigned{address} - row.first;
    if ((row.functions & function) != 0 && index < width_of(row.width, model) && meets(model, row.needs)) {
      return &row;
    }
  }
  return nullptr;
}

}  // namespace

const BitRow* find_bits(const Model& model, Functions function, std::uint16_t address) {
  return find_in(kBitRows, model, function, address);
}

const WordRow* find_words(const Model& model, Functions function, std::uint16_t address) {
  return find_in(kWordRows, model, function, address);
}

}  // namespace ex9000::modbus
