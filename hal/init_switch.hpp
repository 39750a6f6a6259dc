// INIT*, active low. On some models, a jumper connects one terminal to INIT* or to another signal. If the
// jumper does not select INIT*, INIT* reads as released.
//
//     bool asserted() const
//         Returns whether INIT* is connected to GND now. The value is not debounced. For the main loop; does
//         not block.
//
// On a board, also:
//
//     void start()
//         Makes the pin an input. Once, before `asserted`.
#pragma once
