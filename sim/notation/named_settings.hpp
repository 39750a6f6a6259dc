// Sets the settings of a module by the names that users write on the command line, in bus files and in
// transcripts.
#pragma once

#include <string>

#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"

namespace ex9000::sim {

/// Sets one setting. `key` is its name: protocol, baud, format, checksum, edge or name. Returns false and
/// changes nothing for any other key. Throws std::invalid_argument with a one-line message if the value is
/// not valid for this setting of this model.
bool set_by_name(Settings& settings, const Model& model, const std::string& key, const std::string& value);

}  // namespace ex9000::sim
