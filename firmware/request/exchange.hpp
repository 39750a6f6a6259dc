// A request, what it comes to, and its reply.
#pragma once

#include "firmware/bytes.hpp"
#include "firmware/line/line_tallies.hpp"
#include "firmware/request/outcome.hpp"
#include "firmware/request/reply.hpp"
#include "firmware/request/state.hpp"

namespace ex9000 {

/// What a handler is given: it reads the request and the module's state, writes the reply, and says in the
/// outcome what is to be done. It changes nothing else; the state is the module's alone.
class Exchange {
 public:
  explicit constexpr Exchange(const Model& model) : state_(model) {}

  [[nodiscard]] const State& state() const { return state_; }
  [[nodiscard]] const LineTallies& tallies() const { return *tallies_; }
  [[nodiscard]] constexpr const Model& model() const { return state_.model(); }

  /// The request as its assembler has accepted it.
  Bytes frame;
  /// Of a DCON request, what stands behind address and key.
  Bytes args;
  /// A Modbus request to address 0.
  bool broadcast = false;
  /// The line's tallies have this request already: it is judged behind its silence, not within.
  bool tallied = false;

  Outcome outcome;

 private:
  friend class Module;
  const LineTallies* tallies_ = nullptr;  ///< from Module::begin on
  State state_;

 public:
  Reply reply;  // last, being large
};

}  // namespace ex9000
