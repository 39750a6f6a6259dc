// Recognises the requests that require an extension: wire.md 12. A reference module without extensions leaves
// the reply to these requests open.
#pragma once

#include <string>

#include "tests/oracles/reference/module.hpp"

namespace ex9000::reference {

/// Returns whether `baud_code` is at most 0xFF and its bits 7:6, the line format, are not both 0.
bool has_line_format(unsigned baud_code);

/// Returns whether the command begins with `~AAR` or `~AAX`, or is `%AANNTTCCFF` with a CC that
/// `has_line_format` accepts. `body`: the characters after the address.
bool is_extension_command(char delimiter, const std::string& body);

/// Returns whether the first coil of the request is 0x08CA, whether the first register is in the range 0x0240
/// to 0x030F, or whether the request sets a CC that `has_line_format` accepts. Returns false if the frame has
/// less than 6 bytes. A range that begins before these addresses and reaches them includes a hole, so every
/// module refuses it. `frame`: without its CRC.
bool is_extension_function(const Bytes& frame);

}  // namespace ex9000::reference
