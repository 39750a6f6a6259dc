#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include "firmware/bytes.hpp"
#include "firmware/time.hpp"
#include "hal/promise.hpp"

namespace ex9000::hal {

/// The longest time between two calls of `poll` during a job. It limits the delay of events without an
/// interrupt, for example the expiry of a timeout.
inline constexpr Duration kMemoryPollPeriod = milliseconds(1);

/// A nonvolatile memory, for example an AT24C64 or a part of a flash. It carries out one job at a time while
/// the main loop continues. If the driver has an interrupt that occurs when the job can continue, this
/// interrupt must call `Device::on_memory`. All functions are for the main loop and do not block.
///
///     void start_read(std::uint16_t address, MutableBytes destination, Time now)
///         Begins to read `destination.size` bytes from `address` on. Call this only while not `busy()`.
///         `destination` must stay valid while `busy()`.
///     void start_write(std::uint16_t address, Bytes source, Time now)
///         Begins to write `source`, which must not cross the end of a 32-byte page. The job ends when the
///         memory has programmed the bytes, not when it has received them. Call this only while not `busy()`.
///         `source` must stay valid while `busy()`.
///     bool poll(Time now)
///         Continues the job. Call this in every pass of the main loop, even if no job is running, because a
///         memory may prepare for the next job. During a job, also call this after each interrupt of the
///         memory and at least every `kMemoryPollPeriod`. If this returns true, call it again immediately,
///         because no interrupt will occur.
///     bool busy() const
///         Returns whether a job is running. A job may end at once: then this is false after `start_...`.
///     bool succeeded() const
///         Returns whether the last job succeeded. A job fails, for example, if the memory does not complete
///         it before the driver's timeout expires. Call this only while not `busy()`.
///
/// True if `T` has these functions.
template <class T, class = void>
inline constexpr bool kIsMemory = false;
template <class T>
inline constexpr bool kIsMemory<
    T, std::void_t<Returns<void, decltype(std::declval<T&>().start_read(
                                     Exactly<std::uint16_t>(), Exactly<MutableBytes>(), Exactly<Time>()))>,
                   Returns<void, decltype(std::declval<T&>().start_write(Exactly<std::uint16_t>(),
                                                                         Exactly<Bytes>(), Exactly<Time>()))>,
                   Returns<bool, decltype(std::declval<T&>().poll(Exactly<Time>()))>,
                   Returns<bool, decltype(std::declval<const T&>().busy())>,
                   Returns<bool, decltype(std::declval<const T&>().succeeded())>>> = true;

}  // namespace ex9000::hal
