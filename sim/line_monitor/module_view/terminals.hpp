// The labels of a module's terminals.
#pragma once

#include <string>

#include "firmware/model/model.hpp"

namespace ex9000::sim {

/// Returns the label of output `channel`, which counts from 0. Relays and PhotoMOS relays are counted from 1
/// on the label and from 0 on the wire.
inline std::string output_terminal(const Model& model, unsigned channel) {
  const bool open_collector = model.output_kind == OutputKind::OpenCollector;
  return open_collector ? "DO" + std::to_string(channel) : "RL" + std::to_string(channel + 1);
}

/// Returns the label of input `channel`, which counts from 0.
inline std::string input_terminal(unsigned channel) { return "DI" + std::to_string(channel); }

/// Returns whether the model has a terminal for INIT*. Models without this terminal have a switch at the
/// rear.
inline bool has_init_terminal(const Model& model) { return model.init_input == InitInput::Terminal; }

}  // namespace ex9000::sim
