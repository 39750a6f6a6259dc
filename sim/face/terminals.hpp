// What is printed at a module's terminals.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <string>
#include <string_view>

#include "firmware/model/model.hpp"

namespace ex9000::sim {

/// Their outputs are relays or PhotoMOS switches, which are counted from 1 on the label, RL1, and from 0 on
/// the wire. All others have open collectors, DO0 and so on.
inline constexpr std::array<std::string_view, 8> kWithRelays{"EX9060D", "EX9063D", "EX9065D",   "EX9066D",
                                                             "EX9067D", "EX9068D", "EX9068D-M", "EX9068AD-M"};

/// All modules had INIT* among the power's terminals once; newer ones have a slide switch at the rear instead
/// (section 1.4 of the manuals), and of these the manuals' first pages say so.
inline constexpr std::array<std::string_view, 2> kWithInitSwitch{"EX9043D-M", "EX9052D-M"};

template <std::size_t size>
bool is_among(const std::array<std::string_view, size>& designations, const Model& model) {
  return std::find(designations.begin(), designations.end(), model.designation) != designations.end();
}

/// Of an output channel, from 0.
inline std::string output_terminal(const Model& model, unsigned channel) {
  return is_among(kWithRelays, model) ? "RL" + std::to_string(channel + 1) : "DO" + std::to_string(channel);
}

inline bool has_init_terminal(const Model& model) { return !is_among(kWithInitSwitch, model); }

/// Of an input channel, from 0.
inline std::string input_terminal(unsigned channel) { return "DI" + std::to_string(channel); }

}  // namespace ex9000::sim
