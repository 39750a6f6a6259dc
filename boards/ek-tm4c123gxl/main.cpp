#include "boards/ek-tm4c123gxl/board.hpp"
// Must follow board.hpp. This file is the same for all boards of the family.
#include "boards/stellaris/composition.hpp"
