// Finds rows of the register map that a function can access on a model; null if there is none.
#pragma once

#include "firmware/registers/rows.hpp"

namespace ex9000::registers {

/// The row that contains all `quantity` (1 to 2000) coils or discrete inputs from `address` on.
const BitRow* find_bits(const Model& model, Functions function, unsigned address, unsigned quantity);
/// `address` may be above 0xFFFF; the result is then null.
const WordRow* find_word(const Model& model, Functions function, unsigned address);
/// A row with kExtension. `address`: 0 to 0xFFFF.
const WordRow* find_extension(const Model& model, unsigned address);

}  // namespace ex9000::registers
