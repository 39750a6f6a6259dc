#include "boards/pico-w/board.hpp"
// composition.hpp must follow board.hpp. All boards with an RP2040 use the same composition.hpp.
#include "boards/rp2040/composition.hpp"
