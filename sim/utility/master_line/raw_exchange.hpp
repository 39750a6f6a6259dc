// Requests that a person has typed, whatever they are.
#pragma once

#include "sim/utility/connection/connection.hpp"

namespace ex9000::utility {

struct RawReply {
  Data bytes;     ///< without the echo of the request; empty: none
  Time delay{0};  ///< from the moment when the port took the request to the first byte
};

/// A DCON reply ends with CR, any other one with a silence. `patience`: for its first byte. Throws what
/// Connection throws.
RawReply raw_exchange(Connection& connection, const Data& request, Time patience);

}  // namespace ex9000::utility
