// Finds rows of the register map.
#pragma once

#include "firmware/registers/rows.hpp"

namespace ex9000::registers {

/// Returns the row that `function` can access on this model, and that contains all `quantity` (1 to 2000)
/// coils or discrete inputs from `address` on. Returns null if there is no such row.
const BitRow* find_bits(const Model& model, Functions function, unsigned address, unsigned quantity);
/// Returns the row that `function` can access on this model, and that contains the register `address`.
/// Returns null if there is no such row. `address` may be above 0xFFFF; the result is then null.
const WordRow* find_word(const Model& model, Functions function, unsigned address);
/// Returns the row of the extension register `address` (0 to 0xFFFF), or null if this model has no extension
/// register with this address.
const WordRow* find_extension(const Model& model, unsigned address);

}  // namespace ex9000::registers
