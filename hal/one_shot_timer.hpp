// A timer that expires once after each start, and then causes an interrupt. `Device` requires two timers:
//
//   - The silence timer. Its interrupt calls `Device::on_silence`. At the baud rates of a module, the timer
//     is set to a time between 78 us and 34 ms. Its interrupt and the receive interrupt must not interrupt
//     each other. If both are pending, the interrupt of the silence timer must run first, because a byte
//     after the silence does not belong to the frame before the silence.
//   - The wake timer. Its interrupt calls `Device::on_wake_timer`. The timer is set to the time until the
//     next deadline, 1 us to 30 s. On a board, the main loop sets it again after each tick, every 10 ms. A
//     timer of 16 bits at 1 MHz (65.535 ms) therefore suffices: if it is set to more than 65 ms, it may
//     expire after 65 ms. If this timer failed, the main loop would act after the next tick.
//
//     void restart(Duration after)
//         Makes the timer expire once, when the duration `after` has passed: never early, and at most 5 us
//         late. Cancels an earlier start, even if its interrupt is already pending. For interrupts and the
//         main loop; does not block.
//
// On a board, also:
//
//     static void start()
//         Enables the interrupt of the timer. Once, before `restart`.
//     static bool take_expiry()
//         Returns whether the timer has expired since the last `restart`, and clears the flag of the expiry.
//         The handler of the timer calls this first and does nothing if the result is false, because another
//         interrupt may have restarted the timer while this one was pending.
#pragma once
