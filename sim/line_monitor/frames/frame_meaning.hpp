// The meaning of a frame in a few words, from the firmware's own tables.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::sim {

using FrameBytes = std::vector<std::uint8_t>;

enum class Speaker { Master, Module };

/// What modules send in the windows of an arbitration (extensions.md, scan).
bool is_arbitration(const FrameBytes& bytes);

/// A delimiter, perhaps after 00 and LF, or a reply's first character; printable characters; perhaps CR.
bool looks_like_dcon(const FrameBytes& bytes);
/// Also a damaged one, which begins so, ends with CR, and is not a Modbus frame with a correct CRC.
bool was_dcon(const FrameBytes& bytes);

/// For people: the characters of a DCON frame, with \r, \n and \0 for CR, LF and 00; any other in hex.
std::string shown(const FrameBytes& bytes);

/// A wrong CRC, too few bytes for Modbus, a wrong checksum in a DCON request, or DCON characters that are not
/// printable. Empty: the bytes alone show no error. A single control character (LF after CR) is none.
std::string check_error(const FrameBytes& bytes, Speaker speaker);

/// The meaning, the error (`check_error`), or both; empty if neither is known.
std::string meaning(const FrameBytes& bytes, Speaker speaker);

}  // namespace ex9000::sim
