// The commands and registers as CSV, for spreadsheets and tag lists.
#pragma once

#include <string>

#include "sim/describe/models.hpp"

namespace ex9000::sim {

/// Returns a header row and one row for each DCON command, coil, discrete input and register. The format is
/// RFC 4180; lines end with CR LF.
std::string csv_of(const Models& models);

}  // namespace ex9000::sim
