// The composition of a Pico, compiled for the host. A mutation run compares the object code of this file to
// find out whether a change of a driver changes the image. This object code does not run.
#define main main_of_the_image
#include "boards/pico/board.hpp"
// composition.hpp must follow board.hpp, because it uses the pins that board.hpp defines.
#include "boards/rp2040/composition.hpp"
#undef main
