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
/// Returns whether the bytes have the form of a DCON frame or of a damaged DCON frame. A damaged frame begins
/// and ends like a DCON frame and has no correct CRC.
bool was_dcon(const FrameBytes& bytes);

/// Returns the bytes as text for people: DCON as text with \r, \n and \0, everything else in hex.
std::string shown(const FrameBytes& bytes);

/// Describes an error that receivers detect: a wrong CRC, too few bytes, a wrong checksum if the request has
/// one, or characters that are not printable. Returns an empty string if there is no error, or if the bytes
/// alone do not reveal it.
std::string check_error(const FrameBytes& bytes, Speaker speaker);

/// Returns the meaning of a frame, its error (see `check_error`), or both; empty if neither is known.
std::string meaning(const FrameBytes& bytes, Speaker speaker);

}  // namespace ex9000::sim
