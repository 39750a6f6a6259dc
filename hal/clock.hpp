// A free-running clock. Its time wraps; see Time.
//
//     Time now() const
//         Returns the time. It never goes back, except when it wraps. For interrupts and the main loop; does
//         not block.
//     Time now_in_interrupt() const
//         Returns the same time as `now`. The call may take less time than a call of `now`. Only for
//         interrupts that the clock's own interrupt cannot interrupt.
#pragma once
