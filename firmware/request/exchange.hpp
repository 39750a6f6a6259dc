// A request, its outcome and its reply.
#pragma once

#include "firmware/bytes.hpp"
#include "firmware/line/frame_queue.hpp"
#include "firmware/line/line_tallies.hpp"
#include "firmware/request/outcome.hpp"
#include "firmware/request/reply.hpp"
#include "firmware/request/state.hpp"

namespace ex9000 {

/// The argument of a handler, the C++ function for a DCON command or Modbus function. It writes the reply,
/// records in the outcome what the module must do, and changes nothing else. It leaves the rules of
/// `judge_outcome` to that function.
struct Exchange {
  constexpr Exchange(const State& state_of_module, const LineTallies& tallies_of_line)
      : state(state_of_module), tallies(tallies_of_line) {}

  const State& state;
  const LineTallies& tallies;  ///< the counts already include this request

  Bytes frame;  ///< the request without checksum, CRC and CR; valid until it has been judged
  Bytes args;   ///< the arguments of a DCON command (dcon/commands.hpp); set before a DCON handler runs
  bool by_serial_number{};  ///< Modbus: the serial number precedes `frame`, which begins with its last byte
  bool broadcast{};         ///< Modbus: the request has address 0

  Outcome outcome;
  Reply reply;

  /// The rules for every request: the model must be able to store the changed settings, and nothing drives
  /// outputs while the timeout status is set.
  [[nodiscard]] Refusal judge_outcome() const {
    if (outcome.changes_settings() &&
        !outcome.change().applied_to(state.settings).possible_for(state.model())) {
      return Refusal::WrongValue;
    }
    return outcome.drives_outputs() && state.outputs_blocked() ? Refusal::OutputsBlocked : Refusal::None;
  }
  [[nodiscard]] constexpr const Model& model() const { return state.model(); }
  /// For the next request. The outcome must be clear.
  void begin(const Frame& request) {
    frame = request.bytes();
    by_serial_number = request.by_serial_number;
    outcome.refusal = Refusal::None;
    reply.clear();
  }
};

}  // namespace ex9000
