#include "boards/ek-tm4c123gxl/board.hpp"
// The rest is the same for every board of the family.
#include "boards/stellaris/composition.hpp"
