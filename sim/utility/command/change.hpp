// Changes settings of a module, all or with a word about what is not changed.
#pragma once

#include <map>
#include <string>

#include "sim/utility/command/opened.hpp"

namespace ex9000::utility {

/// By the key of a property.
using Values = std::map<std::string, std::string>;

/// Of all settings that the module has in its protocol.
Values read_all(Opened& opened);

struct ChangeOptions {
  bool dry_run = false;
  std::string lead;      ///< of each line
  bool in_part = false;  ///< what the module takes only in ASCII may wait
};

/// Says what changes, changes it in the order of the table, and reads it back. Whatever can be refused is
/// refused before the first change; an error after that says what has been changed. Returns whether nothing
/// has to wait. Throws like Device; std::invalid_argument for a value that the module cannot have.
bool change(Environment& environment, Opened& opened, const Values& values, const ChangeOptions& options);

}  // namespace ex9000::utility
