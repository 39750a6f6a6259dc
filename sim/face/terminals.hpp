// What is printed at a module's terminals.
#pragma once

#include <algorithm>
#include <array>
#include <string>
#include <string_view>

#include "firmware/model/model.hpp"

namespace ex9000::sim {

/// Relays and PhotoMOS switches are counted from 1 on the label, and from 0 on the wire.
struct OutputLabel {
  std::string_view designation;
  std::string_view prefix;
  unsigned first;
};

inline constexpr OutputLabel kOpenCollectorLabel{"", "DO", 0};
inline constexpr std::array<OutputLabel, 8> kOutputLabels{{
    {"EX9060D", "RL", 1},
    {"EX9063D", "RL", 1},
    {"EX9065D", "RL", 1},
    {"EX9066D", "RL", 1},
    {"EX9067D", "RL", 1},
    {"EX9068D", "RL", 1},
    {"EX9068D-M", "RL", 1},
    {"EX9068AD-M", "RL", 1},
}};

/// Of an output channel, from 0.
inline std::string output_terminal(const Model& model, unsigned channel) {
  const auto* const row =
      std::find_if(kOutputLabels.begin(), kOutputLabels.end(),
                   [&model](const OutputLabel& label) { return label.designation == model.designation; });
  const OutputLabel& label = row == kOutputLabels.end() ? kOpenCollectorLabel : *row;
  return std::string(label.prefix) + std::to_string(label.first + channel);
}

/// Whether the power's terminals have INIT* among them. All modules had once; newer ones have a slide switch
/// at the rear instead (section 1.4 of the manuals), and of these two the manuals' first pages say so.
inline bool has_init_terminal(const Model& model) {
  return model.designation != "EX9043D-M" && model.designation != "EX9052D-M";
}

/// Of an input channel, from 0.
inline std::string input_terminal(unsigned channel) { return "DI" + std::to_string(channel); }

}  // namespace ex9000::sim
