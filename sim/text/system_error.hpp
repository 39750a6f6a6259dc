// The reason why a system call has failed, in the system's words.
#pragma once

#include <cerrno>
#include <cstring>
#include <string>

namespace ex9000::sim {

/// Call it directly after the system call, because the next one may change errno.
inline std::string reason() { return std::strerror(errno); }

}  // namespace ex9000::sim
