#pragma once

#include <cstddef>

namespace ex9000::hal {

/// The size in bytes of the smallest page of any supported EEPROM. No write crosses the end of a page, so a
/// power failure damages at most one page.
inline constexpr std::size_t kEepromPage = 32;

/// An EEPROM or FRAM, for example an AT24C64. It carries out one job at a time while the main loop continues.
/// All functions are for the main loop and do not block. Call the `start_...` functions only while not
/// `busy()`; their buffers must stay valid while `busy()`.
///
///     void start_read(std::uint16_t address, MutableBytes destination, Time now)
///         Begins to read `destination.size` bytes from `address` on.
///     void start_write(std::uint16_t address, Bytes source, Time now)
///         Begins to write `source`, which must not cross the end of a page. The job ends when the memory has
///         programmed the bytes, not when it has received them.
///     bool poll(Time now)
///         Continues the job. The rules of `poll` in hal/memory.hpp apply.
///     bool busy() const
///         Returns whether a job is running.
///     bool succeeded() const
///         Returns whether the last job succeeded. A job fails, for example, if the memory does not complete
///         it before the driver's timeout expires. Call this only while not `busy()`.

}  // namespace ex9000::hal
