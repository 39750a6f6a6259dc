// Blocks of a pcapng file: draft-ietf-opsawg-pcapng, whose names these are. Little-endian throughout; a
// reader tells by the Section Header Block's magic.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::sim::pcapng {

using Block = std::vector<std::uint8_t>;

/// 4.1: what a file begins with. `userappl` is the program that writes it.
Block section_header(const std::string& userappl);

/// 4.2: where packets come from; interfaces count from 0 in the order of their blocks. Its packets are of any
/// length, and their times in nanoseconds (if_tsresol 9).
Block interface_description(std::uint16_t link_type, const std::string& name);

/// 4.3.1: bits 0 and 1 of epb_flags.
enum class Direction : std::uint32_t { Inbound = 1, Outbound = 2 };

/// 4.3.
struct EnhancedPacket {
  std::uint32_t interface_id = 0;
  std::chrono::nanoseconds timestamp{0};  ///< since 1970-01-01 00:00:00 UTC
  Direction direction = Direction::Inbound;
  std::vector<std::uint8_t> data;
  std::string comment;  ///< opt_comment; empty: none. What is beyond 65535 bytes is left out
};
Block enhanced_packet(const EnhancedPacket& packet);

}  // namespace ex9000::sim::pcapng
