// The meaning of a frame in a few words, from the firmware's own tables.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::sim {

using FrameBytes = std::vector<std::uint8_t>;

enum class Speaker { Master, Module };

/// Whether the bytes look like a DCON frame: a delimiter or a reply's lead character, then printable
/// characters, up to CR.
bool looks_like_dcon(const FrameBytes& bytes);
/// Whether the bytes look like a DCON frame, or begin and end like one and have no correct CRC: a DCON frame
/// that was damaged.
bool was_dcon(const FrameBytes& bytes);

/// Returns the bytes as text for people: DCON as text with \r, everything else in hex.
std::string shown(const FrameBytes& bytes);

/// Describes errors that receivers detect: a wrong CRC, a wrong checksum if the command requires one, or
/// characters that DCON does not have. Empty: no error, or it is not possible to tell.
std::string check_error(const FrameBytes& bytes, Speaker speaker);

/// Empty if the meaning is unknown.
std::string meaning(const FrameBytes& bytes, Speaker speaker);

}  // namespace ex9000::sim
