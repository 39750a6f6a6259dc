// Replaces hal/registers/bus.hpp in host tests of the RP2040's drivers.
#pragma once

#include "tests/hal/rp2040/bus.hpp"
