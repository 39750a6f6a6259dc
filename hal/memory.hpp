#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include "firmware/bytes.hpp"
#include "firmware/time.hpp"
#include "hal/promise.hpp"

namespace ex9000::hal {

/// What no interrupt tells of, such as a bus that does not move, is noticed within this time.
inline constexpr Duration kMemoryPollPeriod = milliseconds(1);

/// A nonvolatile memory that takes its time, such as an AT24C64: one job at once, begun here and looked after
/// while the main loop goes on. Where an interrupt tells that it can go on, that calls `Device::on_memory`.
///
///     void start_read(std::uint16_t address, MutableBytes destination, Time now)
///         Begins to read `destination.size` bytes from `address` on. Main loop, only while not `busy()`;
///         does not block. `destination` lives until then.
///     void start_write(std::uint16_t address, Bytes source, Time now)
///         Begins to write; the job never crosses a 32-byte page. Ends when the memory has programmed the
///         bytes, not when it has taken them. `source` lives until then. Likewise.
///     bool poll(Time now)
///         Continues the job. Main loop, behind every interrupt of the memory, and every `kMemoryPollPeriod`;
///         does not block. True: must be called again at once, no interrupt will tell when.
///     bool busy() const
///         Whether a job is under way. Main loop.
///     bool succeeded() const
///         Whether the last job succeeded; false where the memory did not answer or took longer than its data
///         sheet says. Main loop, while not `busy()`.
///
/// Whether `T` offers that.
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
