// What a frame on the line means, in a few words from the core's own tables.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::sim {

using FrameBytes = std::vector<std::uint8_t>;

enum class Speaker { Master, Module };

/// Whether the bytes are a DCON frame, as far as one can tell: a delimiter or a reply's lead, then printable
/// characters, up to CR.
bool looks_like_dcon(const FrameBytes& bytes);
/// Likewise, or else the bytes begin and end as one and have no right CRC: it was one before it was damaged.
bool was_dcon(const FrameBytes& bytes);

/// As people read it: DCON as text with \r, everything else in hex.
std::string shown(const FrameBytes& bytes);

/// What receivers find wrong: a CRC, a checksum where the command cannot be without one, characters that DCON
/// does not have. Empty: nothing, or nobody can tell.
std::string check_error(const FrameBytes& bytes, Speaker speaker);

/// Empty where nothing can be told.
std::string meaning(const FrameBytes& bytes, Speaker speaker);

}  // namespace ex9000::sim
