#include "boards/lm3s6965evb/board.hpp"
// The rest is the same for every board of the family.
#include "boards/stellaris/composition.hpp"
