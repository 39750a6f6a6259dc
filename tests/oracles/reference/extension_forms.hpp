// Recognises the requests that only a module with extensions has: wire.md 12. A reference module without
// extensions leaves the reply to these requests open.
#pragma once

#include <string>

#include "tests/oracles/reference/module.hpp"

namespace ex9000::reference {

/// Returns whether bits 7:6 of CC, which are the line format, are not 0.
bool has_line_format(unsigned baud_code);

/// Returns whether the command begins like `~AARD` or `~AAX`, or is a `%` with a line format.
bool is_extension_command(char delimiter, const std::string& body);

/// Returns whether the first coil or register of the request is one of the extensions, or whether the request
/// sets a line format. Any other range that touches an extension has a hole before it, so it is refused in
/// any case. `frame`: without its CRC.
bool is_extension_function(const Bytes& frame);

}  // namespace ex9000::reference
