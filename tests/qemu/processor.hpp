// Selects the host processor on which a test and its emulator run. The test and the emulator run alternately.
// The threads of the emulator also run alternately. On several processors, the host would require more time
// to wake threads than for all other work.
#pragma once

namespace ex9000::rig {

/// Binds the calling thread, and every thread or process that it starts from now on, to the processor of the
/// host with this number. The first processor has the number 0. The threads get the scheduling policy
/// SCHED_BATCH: a thread with this policy does not preempt the thread that wakes it.
void bind_to_processor(int processor);

/// Calls `bind_to_processor` with the processor on which the calling thread runs now. Has no effect if the
/// thread is already bound to one processor.
void bind_to_one_processor();

}  // namespace ex9000::rig
