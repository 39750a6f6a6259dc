#include "boards/pico-w/board.hpp"
// composition.hpp must follow board.hpp. All boards of the family use the same composition.hpp.
#include "boards/rp2040/composition.hpp"
