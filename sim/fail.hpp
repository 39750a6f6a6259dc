// How what somebody has written is refused.
#pragma once

#include <stdexcept>
#include <string>

namespace ex9000::sim {

/// One line that names what is wrong and what would be right.
[[noreturn]] inline void fail(const std::string& what) { throw std::invalid_argument(what); }

}  // namespace ex9000::sim
