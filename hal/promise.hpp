// Helpers with which the compiler checks the function signatures that hal/ requires.
#pragma once

#include <type_traits>

namespace ex9000::hal {

/// An argument that converts to `T` only. A function whose parameter has a wider or narrower type cannot be
/// called with it.
template <class T>
struct Exactly {
  template <class U, class = std::enable_if_t<std::is_same_v<U, T>>>
  operator U() const;  // NOLINT(google-explicit-constructor): the implicit conversion is intended
};

/// A type that is valid only if `Returned`, the return type of a call, is exactly `Wanted`.
template <class Wanted, class Returned>
using Returns = std::enable_if_t<std::is_same_v<Wanted, Returned>>;

}  // namespace ex9000::hal
