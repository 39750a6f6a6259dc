// The system's text for the reason why a system call has failed.
#pragma once

#include <cerrno>
#include <cstring>
#include <string>

namespace ex9000::sim {

/// Returns the text for errno. Call this directly after the system call, because another call may change
/// errno.
inline std::string reason() { return std::strerror(errno); }

}  // namespace ex9000::sim
