// Why a system call has failed, in the system's words.
#pragma once

#include <cerrno>
#include <cstring>
#include <string>

namespace ex9000::sim {

/// Right behind the call: the next one may change it.
inline std::string reason() { return std::strerror(errno); }

}  // namespace ex9000::sim
