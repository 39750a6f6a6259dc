// The words that descriptions use for the access of DCON commands and of rows of the Modbus map.
#pragma once

#include "firmware/dcon/commands.hpp"

namespace ex9000::sim {

/// Returns `read`, `write` or `stored`.
constexpr const char* access_text(dcon::Access access) {
  return access == dcon::Access::Read ? "read" : access == dcon::Access::Write ? "write" : "stored";
}

/// Returns `read, write`, `read` or `write`. At least one argument must be true.
constexpr const char* access_text(bool reads, bool writes) {
  return reads && writes ? "read, write" : reads ? "read" : "write";
}

}  // namespace ex9000::sim
