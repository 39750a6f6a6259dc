// Requests that a person has typed, whatever they are.
#pragma once

#include "sim/utility/connection/connection.hpp"

namespace ex9000::utility {

struct RawReply {
  Data bytes;     ///< without the echo of the request; empty: none
  Time delay{0};  ///< from the moment when the port took the request to the first byte
};

/// Sends after a silence, so that modules take it for a request of its own. Throws what Connection throws.
void raw_send(Connection& connection, const Data& request);

/// A DCON reply ends with CR, any other one with a silence. `patience`: for its first byte. `echoes`: what
/// equals the request is its echo, else perhaps its reply. Throws what Connection throws.
RawReply raw_exchange(Connection& connection, const Data& request, Time patience, bool echoes);

}  // namespace ex9000::utility
