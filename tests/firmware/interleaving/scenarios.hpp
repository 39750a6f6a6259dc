// The scenarios that the tests play at many points.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tests/firmware/interleaving/outcomes.hpp"
#include "tests/firmware/interleaving/scenario.hpp"

namespace ex9000::interleaving {

/// Returns a scenario for the DCON module EX9055D with factory settings, but 115200 baud.
Scenario dcon(const char* name, Step before, std::vector<Step> script,
              std::vector<std::vector<std::string>> replies, std::function<Parts(Bench&)> comes_to);

/// Returns a scenario for the Modbus module EX9042D-M with factory settings, but 115200 baud.
Scenario modbus(const char* name, Step before, std::vector<Step> script,
                std::vector<std::vector<std::string>> replies, std::function<Parts(Bench&)> comes_to);

/// Returns the scenarios that must have a permitted outcome at every point.
std::vector<Scenario> scenarios();

}  // namespace ex9000::interleaving
