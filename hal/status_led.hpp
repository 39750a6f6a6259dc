// The status LED.
//     void light(bool on)    From the main loop, at least at every tick. Does not block.
//     void start()           On a board: makes the pin an output, with the LED off. Once, before `light`.
#pragma once
