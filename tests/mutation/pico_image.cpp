// The composition of a Pico, compiled for the host. Mutation compares its object code, to see whether a
// change of a driver changes the image. It does not run.
#define main main_of_the_image
#include "boards/pico/board.hpp"
// composition.hpp must follow board.hpp.
#include "boards/rp2040/composition.hpp"
#undef main
