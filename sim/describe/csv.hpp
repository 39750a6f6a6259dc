// The commands and registers, for spreadsheets and tag lists.
#pragma once

#include <string>

#include "sim/describe/models.hpp"

namespace ex9000::sim {

/// A head and one row a DCON command, coil, discrete input or register; as in RFC 4180, lines end with CR LF.
std::string csv_of(const Models& models);

}  // namespace ex9000::sim
