// Recognises the requests that require an extension: wire.md 12. A reference module without extensions leaves
// the reply to these requests open.
#pragma once

#include <string>

#include "tests/oracles/reference/module.hpp"

namespace ex9000::reference {

/// Returns whether bits 7:6 of CC, which are the line format, are not 0.
bool has_line_format(unsigned baud_code);

/// Returns whether the command begins like `~AARD` or `~AAX`, or is a `%` with a line format.
bool is_extension_command(char delimiter, const std::string& body);

/// Returns whether the first coil or register of the request is one of the extensions, or whether the request
/// sets a line format. A range that begins before an extension and reaches it includes a hole, so every
/// module refuses it. `frame`: without its CRC.
bool is_extension_function(const Bytes& frame);

}  // namespace ex9000::reference
