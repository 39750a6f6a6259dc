// A nonvolatile memory for the record of the settings (firmware/settings/record.hpp), for example two places
// in an EEPROM or a log in a flash. It carries out one job at a time while the main loop continues. If the
// driver has an interrupt that occurs when the job can continue, this interrupt must call
// `Device::on_memory`. All functions are for the main loop and do not block.
//
//     void start(const MemoryJob& job, Time now)
//         Accepts a job. Call this only while not `busy()`, and then call `poll` immediately.
//     bool poll(Time now)
//         Continues the job. Call this in every pass of the main loop, even if no job is running, because a
//         memory may prepare for the next job. During a job, also call this after each interrupt of the
//         memory and at least every `kMemoryPollPeriod`. If this returns true, call it again immediately,
//         because no interrupt will occur.
//     bool busy() const
//         Returns whether a job is running.
//     MemoryResult result() const
//         Call this only while not `busy()`.
#pragma once

#include <array>
#include <cstdint>

#include "firmware/settings/memory_job.hpp"
#include "firmware/settings/record.hpp"
#include "firmware/time.hpp"

namespace ex9000::hal {

/// The longest time between two calls of `poll` during a job. It limits the delay of events without an
/// interrupt, for example the expiry of a timeout.
inline constexpr Duration kMemoryPollPeriod = milliseconds(1);

/// Zeros in the first bytes of a record, which include its layout, withdraw it.
inline constexpr std::array<std::uint8_t, 8> kNoRecord{};

}  // namespace ex9000::hal
