#include "boards/ek-tm4c123gxl/board.hpp"
// composition.hpp must follow board.hpp. All boards of the family use the same composition.hpp.
#include "boards/stellaris/composition.hpp"
