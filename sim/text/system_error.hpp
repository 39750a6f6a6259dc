// Why a system call has failed.
#pragma once

#include <cerrno>
#include <cstring>
#include <string>

namespace ex9000::sim {

/// Reads errno, so call it directly after the system call.
inline std::string reason() { return std::strerror(errno); }

}  // namespace ex9000::sim
