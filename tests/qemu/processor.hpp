// The processor of the host that a test and its emulator run on. They take turns, and so do the emulator's
// own threads: to wake one another across processors would take longer than all the rest.
#pragma once

namespace ex9000::rig {

/// The calling thread, and whatever it starts from here on, runs on this processor of the host, from 0.
/// Whoever wakes another there goes on until it waits itself.
void stay_on_processor(int processor);

/// Likewise, on the one where it runs at this moment, unless one was chosen before.
void stay_on_one_processor();

}  // namespace ex9000::rig
