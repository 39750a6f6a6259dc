// Sets a rate like the Rust crates serialport and serial2, which do not use the C library for it.
#pragma once

#include <cstdint>

namespace ex9000::system {

/// Sets both rates of the terminal `fd` to `baud` bits per second, with TCSETS2 and BOTHER. Returns false if
/// that fails.
bool set_any_rate(int fd, std::uint32_t baud);

}  // namespace ex9000::system
