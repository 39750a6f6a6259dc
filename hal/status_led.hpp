// The status LED.
//
//     void light(bool on)
//         Turns the LED on or off. The main loop calls this at least at every tick. This does not block.
#pragma once
