#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include "hal/promise.hpp"

namespace ex9000::hal {

/// The output channels: open collectors, relays or PhotoMOS. From reset until the first `drive` all are
/// de-energised.
///
///     void drive(std::uint16_t channels)
///         Bit n is channel n, 1 = energised (the transistor conducts, the relay is pulled); polarity is the
///         board's. All channels change together, those that stay the same without a glitch. Main loop, every
///         turn; does not block.
///
/// Whether `T` offers that.
template <class T, class = void>
inline constexpr bool kIsOutputs = false;
template <class T>
inline constexpr bool
    kIsOutputs<T, std::void_t<Returns<void, decltype(std::declval<T&>().drive(Exactly<std::uint16_t>()))>>> =
        true;

}  // namespace ex9000::hal
