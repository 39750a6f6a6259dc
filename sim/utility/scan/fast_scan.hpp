// The bus scan by serial numbers (extensions.md, scan), which modules for Wiren Board's tools answer.
#pragma once

#include <cstdint>
#include <vector>

#include "sim/utility/master_line/master_line.hpp"

namespace ex9000::utility {

struct Scanned {
  std::uint32_t serial_number;
  std::uint8_t address;
};

/// In the line's mode, in the order of their serial numbers. `latency`: of the port. A scan that is disturbed
/// begins anew, a few times; then the result may lack modules. Throws what Connection throws.
std::vector<Scanned> fast_scan(MasterLine& line, Time latency);

}  // namespace ex9000::utility
