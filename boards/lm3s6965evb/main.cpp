#include "boards/lm3s6965evb/board.hpp"
// Must follow board.hpp. This file is the same for all boards of the family.
#include "boards/stellaris/composition.hpp"
