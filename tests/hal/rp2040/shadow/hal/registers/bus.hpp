// Host tests of the RP2040's drivers include this file instead of hal/registers/bus.hpp.
#pragma once

#include "tests/hal/rp2040/bus.hpp"
