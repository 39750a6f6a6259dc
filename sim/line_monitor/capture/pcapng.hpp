// Blocks of a pcapng file: draft-ietf-opsawg-pcapng, which also defines the names used here. All values are
// little-endian; readers detect this from the magic number of the Section Header Block.
#pragma once

#include <chrono>
#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::sim::pcapng {

using Block = std::vector<std::uint8_t>;

/// Returns a Section Header Block (4.1), the first block of a file. `userappl` names the program that writes
/// the file.
Block section_header(const std::string& userappl);

/// Returns an Interface Description Block (4.2), which describes a source of packets. Interfaces are numbered
/// from 0 in the order of their blocks. Packets may have any length. The times of packets are in nanoseconds
/// (if_tsresol 9).
Block interface_description(std::uint16_t link_type, const std::string& name);

/// Bits 0 and 1 of epb_flags (4.3.1).
enum class Direction : std::uint32_t { Inbound = 1, Outbound = 2 };

/// The content of an Enhanced Packet Block (4.3).
struct EnhancedPacket {
  std::uint32_t interface_id = 0;
  std::chrono::nanoseconds timestamp{0};  ///< since 1970-01-01 00:00:00 UTC
  Direction direction = Direction::Inbound;
  std::vector<std::uint8_t> data;
  std::string comment;  ///< opt_comment, cut after 65535 bytes; empty: none
};
Block enhanced_packet(const EnhancedPacket& packet);

}  // namespace ex9000::sim::pcapng
