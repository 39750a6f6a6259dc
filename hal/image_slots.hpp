// Two places for images of the firmware in a flash: firmware/update/slot.hpp. One job at a time, while the
// main loop continues. For the main loop; nothing blocks.
//     update::Origin origin() const    Where the running image comes from, and both slots' heads at the
//     reset. void start(const update::SlotJob& job, Time now)
//         Only while not `busy()`. Then call `poll` at once.
//     bool poll(Time now)
//         In every pass, even without a job. If true, call it again at once, because no interrupt will occur.
//     bool busy() const                A job is running.
// A job of the settings (hal/memory.hpp) never waits for more than one program operation of a job here, even
// if both memories are parts of one flash.
#pragma once

#include "firmware/time.hpp"
#include "firmware/update/slot_job.hpp"  // IWYU pragma: export
