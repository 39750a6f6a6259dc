// The meaning of a frame in a few words, from the firmware's own tables.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::sim {

using FrameBytes = std::vector<std::uint8_t>;

enum class Speaker { Master, Module };

/// Returns whether the bytes have the form of a DCON frame: a delimiter or the first character of a reply,
/// then printable characters, then optionally CR. Bytes 00 and LF may precede a delimiter.
bool looks_like_dcon(const FrameBytes& bytes);
/// Returns whether the bytes have the form of a DCON frame or of a damaged DCON frame. A damaged DCON frame
/// begins with a delimiter or the first character of a reply, ends with CR, and is not a Modbus frame with a
/// correct CRC.
bool was_dcon(const FrameBytes& bytes);

/// Returns the bytes as text for people. If the bytes have the form of a DCON frame, the text contains their
/// characters, with \r, \n and \0 in place of CR, LF and 00. Otherwise the text contains the bytes in hex.
std::string shown(const FrameBytes& bytes);

/// Describes an error in the bytes: a wrong CRC, too few bytes for a Modbus frame, a wrong checksum in a DCON
/// request, or characters of a DCON frame that are not printable. Returns an empty string if the bytes alone
/// do not reveal an error. A single control character is not an error, for example an LF after CR.
std::string check_error(const FrameBytes& bytes, Speaker speaker);

/// Returns the meaning of a frame, its error (see `check_error`), or both; empty if neither is known.
std::string meaning(const FrameBytes& bytes, Speaker speaker);

}  // namespace ex9000::sim
