// How a contract of hal/ is put so that the compiler checks it.
#pragma once

#include <type_traits>

namespace ex9000::hal {

/// An argument that becomes a `T` and nothing else: a function that takes something wider or narrower cannot
/// be called with it.
template <class T>
struct Exactly {
  template <class U, class = std::enable_if_t<std::is_same_v<U, T>>>
  operator U() const;  // NOLINT(google-explicit-constructor): that it converts is what it is for
};

/// Is a type only if what a call returns is `Wanted` itself.
template <class Wanted, class Returned>
using Returns = std::enable_if_t<std::is_same_v<Wanted, Returned>>;

}  // namespace ex9000::hal
