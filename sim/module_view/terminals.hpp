// What is printed at a module's terminals.
#pragma once

#include <string>

#include "firmware/model/model.hpp"

namespace ex9000::sim {

/// The label of an output channel, from 0. Relays and PhotoMOS switches are counted from 1 on the label and
/// from 0 on the wire.
inline std::string output_terminal(const Model& model, unsigned channel) {
  const bool open_collector = model.output_kind == OutputKind::OpenCollector;
  return open_collector ? "DO" + std::to_string(channel) : "RL" + std::to_string(channel + 1);
}

/// The label of an input channel, from 0.
inline std::string input_terminal(unsigned channel) { return "DI" + std::to_string(channel); }

/// INIT* is a terminal beside those of the power supply.
inline bool has_init_terminal(const Model& model) { return model.init_input == InitInput::Terminal; }

}  // namespace ex9000::sim
