// A free-running clock. Its time wraps (see Time), but never goes back otherwise. Nothing blocks.
//     Time now() const                 For interrupts and the main loop.
//     Time now_in_interrupt() const    Maybe faster. Only where the clock's own interrupt cannot occur.
#pragma once
