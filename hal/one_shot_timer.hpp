// A timer that expires once after each start, with an interrupt. `Device` needs two:
//   - The silence timer; its interrupt calls `Device::on_silence`. A module sets it to 1 us to 34 ms. It
//     and the receive interrupt must not interrupt each other. If both are pending, it runs first: a byte
//     after the silence does not belong to the frame before.
//   - The wake timer; its interrupt calls `Device::on_wake_timer`. Set to the next deadline, 1 us to 30 s;
//     on a board again after each tick, every 10 ms. So 16 bits at 1 MHz suffice: set to more than 65 ms, it
//     may expire after 65 ms. If it failed, the main loop would act after the next tick.
//
//     void restart(Duration after)
//         Never early, at most 5 us late. Cancels an earlier start, even if its interrupt is pending. For
//         interrupts and the main loop; does not block.
//     static void start()
//         On a board: enables the interrupt. Once, before `restart`.
//     static bool take_expiry()
//         On a board: whether it has expired since the last `restart`; clears the flag. The handler calls
//         this first and does nothing if false: another interrupt may have restarted the timer meanwhile.
#pragma once
