// Selects the host processor on which a test and its emulator run. They run alternately, and so do the
// threads of the emulator. Waking a thread on another processor would take longer than everything else.
#pragma once

namespace ex9000::rig {

/// Binds the calling thread, and every thread or process that it starts from now on, to this processor of the
/// host, numbered from 0. A thread that wakes another thread continues until it has to wait itself.
void bind_to_processor(int processor);

/// Binds the calling thread in the same way to the processor that it runs on now, unless it is already bound
/// to one.
void bind_to_one_processor();

}  // namespace ex9000::rig
