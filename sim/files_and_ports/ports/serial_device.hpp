// A serial port as a file: opening it, and its mode.
#pragma once

#include <string>

#include "hal/serial_mode.hpp"
#include "sim/files_and_ports/files/file_descriptor.hpp"

namespace ex9000::sim {

/// For one program at a time, if the others lock it too (flock). std::runtime_error: it cannot be opened or
/// is in use.
FileDescriptor open_serial_device(const std::string& device);

/// Raw bytes, no handshake. With parity, the kernel marks line errors (see ParityMarks). Throws
/// std::invalid_argument, and keeps the mode, if the port cannot have this one.
void set_serial_mode(int fd, hal::SerialMode mode);

}  // namespace ex9000::sim
