#pragma once

#include <cstdint>
#include <type_traits>
#include <utility>

#include "hal/promise.hpp"

namespace ex9000::hal {

/// The input channels. Every edge is handed to `Device::on_edge` in the edge interrupt, with the level read
/// after the edge flag was cleared.
///
///     std::uint16_t start()
///         From now on edges are told. Returns the levels they start from: bit n is channel n, 1 = logic 1
///         (+4 to +30 V). Main loop, once after reset; does not block.
///
/// Whether `T` offers that.
template <class T, class = void>
inline constexpr bool kIsInputs = false;
template <class T>
inline constexpr bool
    kIsInputs<T, std::void_t<Returns<std::uint16_t, decltype(std::declval<T&>().start())>>> = true;

}  // namespace ex9000::hal
