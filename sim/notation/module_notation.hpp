// The notation of a module on the command line: MODEL[@ADDR][,KEY=VALUE]...
#pragma once

#include <string>

#include "firmware/model/model.hpp"
#include "sim/virtual_line/line/module_spec.hpp"

namespace ex9000::sim {

/// Parses MODEL[@ADDR][,KEY=VALUE]... Throws std::invalid_argument with a one-line message that says what is
/// wrong and what would be right.
ModuleSpec parse_module_spec(const std::string& text);

// The steps of parse_module_spec. If a key or a value is wrong, they throw like parse_module_spec.

/// Returns a module of this model with factory settings.
ModuleSpec factory_fresh(const Model& model);
/// Takes the value of the setting that module_settings calls `name`. An error begins with `place`.
void take_module_setting(ModuleSpec& spec, const std::string& name, const std::string& place,
                         const std::string& value);
/// Checks that the address is a Modbus address if the protocol is Modbus RTU.
void check(const ModuleSpec& spec);

/// Returns the model with this designation, in upper or lower case, with or without EX. Throws like
/// parse_module_spec.
const Model& model_called(const std::string& name);
/// Throws the std::invalid_argument for `name`, which is not a model. The message has one line, and names the
/// models with similar names.
[[noreturn]] void refuse_model(const std::string& name);

}  // namespace ex9000::sim
