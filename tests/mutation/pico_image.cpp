// The composition of a Pico, compiled for the host. The mutation run compares its object code to find out
// whether a change of a driver changes the image. The program does not run.
#define main main_of_the_image
#include "boards/pico/board.hpp"
// composition.hpp must follow board.hpp.
#include "boards/rp2040/composition.hpp"
#undef main
