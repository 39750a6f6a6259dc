// The settings of a module: `,KEY=VALUE` after its model, and the keys of a module in a bus file.
#pragma once

#include <vector>

#include "sim/notation/setting.hpp"
#include "sim/virtual_line/line/module_spec.hpp"

namespace ex9000::sim {

/// `Setting::take` requires that the model of the module is set.
extern const std::vector<Setting<ModuleSpec>> module_settings;

}  // namespace ex9000::sim
