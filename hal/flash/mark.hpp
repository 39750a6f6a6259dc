// The mark of a sector that is completely erased.
#pragma once

#include <array>
#include <cstdint>

namespace ex9000::hal::flash {

using MarkBytes = std::array<std::uint8_t, 8>;

/// The first bytes of a sector that is erased and unused. The store programs them when an erase has ended. An
/// interrupted erase may leave bytes that read as FF but do not keep what is programmed into them. The store
/// therefore erases a sector without this mark before it uses the sector. The value is arbitrary.
inline constexpr MarkBytes kMark{0x45, 0x58, 0x39, 0xC6, 0xA7, 0x9B, 0x53, 0x1D};

/// The store programs these bytes over the mark before it uses the sector. The mark is therefore gone before
/// the next erase begins, and an interrupted erase does not restore it.
inline constexpr MarkBytes kNoMark{};

}  // namespace ex9000::hal::flash
