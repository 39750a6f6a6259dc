#include "boards/lm3s6965evb/board.hpp"
// composition.hpp must follow board.hpp. All boards of the family use the same composition.hpp.
#include "boards/stellaris/composition.hpp"
