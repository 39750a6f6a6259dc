// The status LED.
//
//     void light(bool on)
//         Turns the LED on or off. The main loop calls this at least at every tick. This does not block.
//
// On a board, also:
//
//     void start()
//         Makes the pin an output, with the LED off. Once, before `light`.
#pragma once
