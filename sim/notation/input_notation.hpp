// The notation of programs that change the level of a module's input: square waves and key presses.
//
//   0 square 100ms                          on for one half of the period, off for the other half
//   3 key at 2s for 300ms                   pressed once
//   3 key every 10s for 300ms bounce 5ms    pressed every 10 s; the contacts bounce for 5 ms
#pragma once

#include <string>

#include "firmware/model/model.hpp"
#include "sim/virtual_line/line/input_program.hpp"

namespace ex9000::sim {

/// `model` says which channels exist.
InputProgram parse_input_program(const std::string& text, const Model& model);

unsigned parse_input(const std::string& text, const Model& model);

}  // namespace ex9000::sim
