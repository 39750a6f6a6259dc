// Blocks of a pcapng file: draft-ietf-opsawg-pcapng, which also defines the names used here. All values are
// little-endian; readers detect this from the magic number of the Section Header Block.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::sim::pcapng {

using Block = std::vector<std::uint8_t>;

/// Section Header Block (4.1), the first of a file. `userappl`: the program that writes it.
Block section_header(const std::string& userappl);

/// Interface Description Block (4.2): a source of packets of any length, with times in ns (if_tsresol 9).
/// Interfaces are numbered from 0 in the order of their blocks.
Block interface_description(std::uint16_t link_type, const std::string& name);

/// Bits 0 and 1 of epb_flags (4.3.1).
enum class Direction : std::uint32_t { Inbound = 1, Outbound = 2 };

/// Enhanced Packet Block (4.3).
struct EnhancedPacket {
  std::uint32_t interface_id = 0;
  std::chrono::nanoseconds timestamp{0};  ///< since 1970-01-01 00:00:00 UTC
  Direction direction = Direction::Inbound;
  std::vector<std::uint8_t> data;
  std::string comment;  ///< opt_comment, cut after 65535 bytes; empty: none
};
Block enhanced_packet(const EnhancedPacket& packet);

}  // namespace ex9000::sim::pcapng
