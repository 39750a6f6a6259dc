#include "boards/ek-tm4c123gxl/board.hpp"
// composition.hpp must follow board.hpp. All boards with a Stellaris or TM4C123 use the same composition.hpp.
#include "boards/stellaris/composition.hpp"
