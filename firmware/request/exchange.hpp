// A request, its outcome and its reply.
#pragma once

#include "firmware/bytes.hpp"
#include "firmware/line/line_tallies.hpp"
#include "firmware/request/outcome.hpp"
#include "firmware/request/reply.hpp"
#include "firmware/request/state.hpp"

namespace ex9000 {

/// The argument of a handler. A handler is the C++ function for a DCON command or a Modbus function. It reads
/// the request, the module's state and the tallies, writes the reply, and records in the outcome what the
/// module must do. It changes nothing else, and leaves to `judge_outcome` what that function judges.
struct Exchange {
  constexpr Exchange(const State& state_of_module, const LineTallies& tallies_of_line)
      : state(state_of_module), tallies(tallies_of_line) {}

  const State& state;
  const LineTallies& tallies;  ///< the counts already include this request

  Bytes frame;       ///< the request without checksum, CRC and CR; valid until it has been judged
  Bytes args;        ///< the arguments of a DCON command (dcon/commands.hpp); set before a DCON handler runs
  bool broadcast{};  ///< whether the request has address 0; for Modbus only

  Outcome outcome;
  Reply reply;

  /// Judges what the handler has recorded in the outcome by the rules that hold for every request: the model
  /// must be able to store the changed settings, and nothing drives outputs while the timeout status is set.
  [[nodiscard]] Refusal judge_outcome() const {
    if (outcome.changes_settings() &&
        !outcome.change().applied_to(state.settings).possible_for(state.model())) {
      return Refusal::WrongValue;
    }
    return outcome.drives_outputs() && state.outputs_blocked() ? Refusal::OutputsBlocked : Refusal::None;
  }
  [[nodiscard]] constexpr const Model& model() const { return state.model(); }
  /// Prepares the exchange, whose outcome is clear, for the next request.
  void begin(Bytes request) {
    frame = request;
    outcome.refusal = Refusal::None;
    reply.clear();
  }
};

}  // namespace ex9000
