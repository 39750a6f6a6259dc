#include "firmware/modbus/registers.hpp"

#include "firmware/model/built.hpp"

namespace ex9000::modbus {

namespace {

// The rows without their texts.
constexpr auto kBitRows = rows_of_built_models<kBitRegisters, &BitRegister::row>();
constexpr auto kWordRows = rows_of_built_models<kWordRegisters, &WordRegister::row>();

template <class Rows>
auto find_in(const Rows& rows, const Model& model, Functions function, std::uint16_t address)
    -> decltype(&rows[0]) {
  for (const auto& row : rows) {
    const unsigned index = unsigned{address} - row.first;
    if ((row.functions & function) != 0 && index < width_of(row.width, model) && has(model, row.needs)) {
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
