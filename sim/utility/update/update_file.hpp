// Update files, NAME.ex9fw: an image in the form in which a master writes it to a module (extensions.md,
// firmware update): what goes to the registers from 0x1000 on, then each block for those from 0x2000 on.
#pragma once

#include <string>
#include <vector>

#include "firmware/update/slot.hpp"
#include "sim/utility/connection/connection.hpp"

namespace ex9000::utility {

struct UpdateFile {
  update::Info info;
  std::vector<Data> blocks;

  /// Of the modules that it is for, for example 9042DM.pico.
  [[nodiscard]] std::string signature() const;
  /// For example D01.00.
  [[nodiscard]] std::string version() const;
};

/// The version in a register (BCD) as a module names it in `$AAF`.
std::string version_text(unsigned bcd);

/// Errors begin with the path: std::runtime_error if it cannot be read, std::invalid_argument if it is
/// damaged or no update.
UpdateFile read_update_file(const std::string& path);

}  // namespace ex9000::utility
