// A request, what it comes to, and its reply.
#pragma once

#include "firmware/bytes.hpp"
#include "firmware/line/line_tallies.hpp"
#include "firmware/request/outcome.hpp"
#include "firmware/request/reply.hpp"
#include "firmware/request/state.hpp"

namespace ex9000 {

/// What a handler gets. It reads the request and the module's state, writes the reply, and says in the
/// outcome what must be done. It changes nothing else.
struct Exchange {
  constexpr Exchange(const State& state_of_module, const LineTallies& tallies_of_line)
      : state(state_of_module), tallies(tallies_of_line) {}

  const State& state;
  const LineTallies& tallies;  ///< this request is counted already

  Bytes frame;             ///< the request as its assembler accepted it
  Bytes args;              ///< of a DCON request, what stands after address and key
  bool broadcast = false;  ///< a Modbus request to address 0

  Outcome outcome;
  Reply reply;

  [[nodiscard]] constexpr const Model& model() const { return state.model(); }
  /// Before the next request is judged.
  void begin(Bytes request) {
    frame = request;
    args = {};
    broadcast = false;
    outcome.clear();
    outcome.refusal = Refusal::None;
    reply.clear();
  }
};

}  // namespace ex9000
