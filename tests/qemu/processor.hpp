// Selects the host processor on which a test and its emulator run. The test and the emulator run alternately.
// The threads of the emulator also run alternately. Waking threads on other processors would take longer than
// all other work.
#pragma once

namespace ex9000::rig {

/// Binds the calling thread, and every thread or process that it starts from now on, to this processor of the
/// host, numbered from 0. The threads get the scheduling policy SCHED_BATCH: a thread with this policy does
/// not preempt the thread that wakes it.
void bind_to_processor(int processor);

/// Binds the calling thread in the same way to the processor that it runs on now, unless it is already bound
/// to one.
void bind_to_one_processor();

}  // namespace ex9000::rig
