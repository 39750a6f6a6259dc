#include "firmware/registers/find.hpp"

#include "firmware/model/built.hpp"
#include "firmware/registers/bits.hpp"
#include "firmware/registers/words.hpp"

namespace ex9000::registers {

namespace {

constexpr auto kBitRows = rows_of_built_models<kBitRegisters, &BitRegister::row>();
constexpr auto kWordRows = rows_of_built_models<kWordRegisters, &WordRegister::row>();

template <class Rows>
auto find_in(const Rows& rows, const Model& model, Functions function, unsigned address, unsigned quantity)
    -> decltype(&rows[0]) {
  for (const auto& row : rows) {
    const unsigned index = address - row.first;
    if (index < kLargestWidth && (row.functions & function) != 0) {
      const unsigned width = width_of(row.width, model);
      if (index < width && has(model, row.needs)) {
        return index + quantity <= width ? &row : nullptr;
      }
    }
  }
  return nullptr;
}

}  // namespace

const BitRow* find_bits(const Model& model, Functions function, unsigned address, unsigned quantity) {
  return find_in(kBitRows, model, function, address, quantity);
}

const WordRow* find_word(const Model& model, Functions function, unsigned address) {
  return find_in(kWordRows, model, function, address, 1);
}

const WordRow* find_extension(const Model& model, unsigned address) {
  const WordRow* row = find_word(model, kReadHoldingRegisters, address);
  return row != nullptr && row->has(kExtension) ? row : nullptr;
}

}  // namespace ex9000::registers
