// INIT*, active low. On some models a jumper connects a terminal to INIT* or to another signal; if not to
// INIT*, it reads as released. For the main loop; nothing blocks.
//     bool asserted() const    Connected to GND now, not debounced.
//     void start()             On a board: makes the pin an input. Once, before `asserted`.
#pragma once
