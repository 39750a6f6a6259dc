// The scenarios. The tests let the steps of each scenario happen at many points of a turn.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/firmware/interleaving/outcomes.hpp"
#include "tests/firmware/interleaving/scenario.hpp"

namespace ex9000::interleaving {

/// Returns a scenario for the DCON module EX9055D. The baud rate is 115200. All other settings have their
/// factory values.
Scenario dcon(const char* name, Step before, std::vector<Step> script,
              std::vector<std::vector<std::string>> replies, std::function<Parts(Bench&)> comes_to);

/// Returns a scenario for the Modbus module EX9042D-M. The baud rate is 115200. All other settings have their
/// factory values.
Scenario modbus(const char* name, Step before, std::vector<Step> script,
                std::vector<std::vector<std::string>> replies, std::function<Parts(Bench&)> comes_to);

/// Returns the scenarios that must have a permitted outcome at every point.
std::vector<Scenario> scenarios();

}  // namespace ex9000::interleaving
