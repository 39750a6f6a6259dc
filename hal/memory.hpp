// A nonvolatile memory for the settings' record (firmware/settings/record.hpp), for example two places in an
// EEPROM or a log in a flash. One job at a time, while the main loop continues. For the main loop; nothing
// blocks. A driver with an interrupt that says that the job can continue calls `Device::on_memory` from it.
//     void start(const MemoryJob& job, Time now)
//         Only while not `busy()`. Then call `poll` at once.
//     bool poll(Time now)
//         In every pass, even without a job, because a memory may prepare for the next one. During a job also
//         after each interrupt of the memory and at least every `kMemoryPollPeriod`. If true, call it again
//         at once, because no interrupt will occur.
//     bool busy() const              A job is running.
//     MemoryResult result() const    Only while not `busy()`.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/settings/memory_job.hpp"
#include "firmware/settings/record.hpp"
#include "firmware/time.hpp"

namespace ex9000::hal {

/// Limits the delay of events without an interrupt during a job, such as the expiry of a timeout.
inline constexpr Duration kMemoryPollPeriod = milliseconds(1);

/// Over the first bytes of a record, which include its layout, these withdraw it.
inline constexpr std::array<std::uint8_t, 8> kNoRecord{};

}  // namespace ex9000::hal
