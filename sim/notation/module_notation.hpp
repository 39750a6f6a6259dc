// The notation of a module on the command line: MODEL[@ADDR][,KEY=VALUE]...
#pragma once

#include <string>

#include "firmware/model/model.hpp"
#include "sim/virtual_line/line/module_spec.hpp"

namespace ex9000::sim {

ModuleSpec parse_module_spec(const std::string& text);

// The steps of parse_module_spec.

ModuleSpec factory_fresh(const Model& model);
/// `name`: in module_settings. An error begins with `place`.
void take_module_setting(ModuleSpec& spec, const std::string& name, const std::string& place,
                         const std::string& value);
/// Modbus requires a Modbus address.
void check(const ModuleSpec& spec);

/// In upper or lower case, with or without EX.
const Model& model_called(const std::string& name);
/// The message names the models with similar names.
[[noreturn]] void refuse_model(const std::string& name);

}  // namespace ex9000::sim
