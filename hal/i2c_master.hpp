// What a driver of an I2C master is asked for and answers.
#pragma once

#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <utility>

#include "firmware/bytes.hpp"
#include "firmware/time.hpp"
#include "hal/promise.hpp"

namespace ex9000::hal {

/// One visit to a device: START, its address, bytes one way, STOP. A driver of a master offers, for the main
/// loop alone and without blocking:
///
///     void begin(const I2cTransfer&, Time now)   only while not busy(); the transfer lives until then
///     bool poll(Time now)                        every turn; true: again at once, no interrupt will tell
///     bool busy() const
///     I2cResult result() const                   of the last transfer, while not busy()
///
struct I2cTransfer {
  std::uint8_t device = 0;   ///< 7 bits
  Bytes header;              ///< written first
  Bytes source;              ///< written behind it
  MutableBytes destination;  ///< filled, where nothing is written

  [[nodiscard]] constexpr bool writes() const { return header.size != 0; }
  [[nodiscard]] constexpr std::size_t size() const {
    return writes() ? header.size + source.size : destination.size;
  }
  /// The byte to be written in place `index`.
  [[nodiscard]] constexpr std::uint8_t byte(std::size_t index) const {
    return index < header.size ? header[index] : source[index - header.size];
  }
};

enum class I2cResult : std::uint8_t {
  Done,
  NoAcknowledge,  ///< nobody answered to the address, or a byte was not taken
  Failed,         ///< the bus did not move: a line is stuck, or somebody else is on it
};

/// Whether `T` offers what I2cTransfer says of a master.
template <class T, class = void>
inline constexpr bool kIsI2cMaster = false;
template <class T>
inline constexpr bool
    kIsI2cMaster<T, std::void_t<Returns<void, decltype(std::declval<T&>().begin(
                                                  std::declval<const I2cTransfer&>(), Exactly<Time>()))>,
                                Returns<bool, decltype(std::declval<T&>().poll(Exactly<Time>()))>,
                                Returns<bool, decltype(std::declval<const T&>().busy())>,
                                Returns<I2cResult, decltype(std::declval<const T&>().result())>>> = true;

}  // namespace ex9000::hal
