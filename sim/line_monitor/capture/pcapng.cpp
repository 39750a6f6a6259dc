#include "sim/line_monitor/capture/pcapng.hpp"

namespace ex9000::sim::pcapng {

namespace {

// Block types, 11.1.
constexpr std::uint32_t kSectionHeaderBlock = 0x0A0D0D0A;
constexpr std::uint32_t kInterfaceDescriptionBlock = 1;
constexpr std::uint32_t kEnhancedPacketBlock = 6;

// Option codes: of all blocks (3.5), then of one type of block.
constexpr std::uint16_t kEndOfOptions = 0;
constexpr std::uint16_t kComment = 1;
constexpr std::uint16_t kSectionUserApplication = 4;
constexpr std::uint16_t kInterfaceName = 2;
constexpr std::uint16_t kInterfaceTimestampResolution = 9;
constexpr std::uint16_t kPacketFlags = 2;

template <class Number>
void put(Block& block, Number number) {
  for (unsigned byte = 0; byte < sizeof number; ++byte) {
    block.push_back(static_cast<std::uint8_t>(static_cast<std::uint64_t>(number) >> 8U * byte));
  }
}

/// Pads the block with zeros to a multiple of four bytes.
template <class Bytes>
void put_padded(Block& block, const Bytes& bytes) {
  block.insert(block.end(), bytes.begin(), bytes.end());
  block.resize((block.size() + 3) / 4 * 4);
}

/// An option (3.5), cut after 65535 bytes. Its length excludes the padding.
void put_option(Block& block, std::uint16_t code, const std::string& value) {
  constexpr std::size_t kLongest = 0xFFFF;
  const std::string fitting = value.substr(0, kLongest);
  put(block, code);
  put(block, static_cast<std::uint16_t>(fitting.size()));
  put_padded(block, fitting);
}

/// A complete block (3.1): type, length, body, length. Adds the end to the options at the end of `body`.
Block framed(std::uint32_t type, Block body) {
  put_option(body, kEndOfOptions, "");
  constexpr std::size_t kTypeAndLengths = 12;
  const auto length = static_cast<std::uint32_t>(body.size() + kTypeAndLengths);
  Block block;
  block.reserve(length);
  put(block, type);
  put(block, length);
  block.insert(block.end(), body.begin(), body.end());
  put(block, length);
  return block;
}

}  // namespace

Block section_header(const std::string& userappl) {
  constexpr std::uint32_t kByteOrderMagic = 0x1A2B3C4D;
  constexpr std::uint16_t kMajorVersion = 1;
  constexpr std::uint16_t kMinorVersion = 0;
  constexpr std::uint64_t kSectionLengthUnknown = UINT64_MAX;
  Block body;
  put(body, kByteOrderMagic);
  put(body, kMajorVersion);
  put(body, kMinorVersion);
  put(body, kSectionLengthUnknown);
  put_option(body, kSectionUserApplication, userappl);
  return framed(kSectionHeaderBlock, std::move(body));
}

Block interface_description(std::uint16_t link_type, const std::string& name) {
  constexpr std::uint16_t kReserved = 0;
  constexpr std::uint32_t kNoSnapLen = 0;
  constexpr char kNanoseconds = 9;  // 10^-9 s
  Block body;
  put(body, link_type);
  put(body, kReserved);
  put(body, kNoSnapLen);
  put_option(body, kInterfaceName, name);
  put_option(body, kInterfaceTimestampResolution, std::string(1, kNanoseconds));
  return framed(kInterfaceDescriptionBlock, std::move(body));
}

Block enhanced_packet(const EnhancedPacket& packet) {
  const auto timestamp = static_cast<std::uint64_t>(packet.timestamp.count());
  const auto length = static_cast<std::uint32_t>(packet.data.size());
  Block body;
  put(body, packet.interface_id);
  put(body, static_cast<std::uint32_t>(timestamp >> 32U));
  put(body, static_cast<std::uint32_t>(timestamp));
  put(body, length);  // captured length
  put(body, length);  // original length
  put_padded(body, packet.data);
  put(body, kPacketFlags);
  put(body, static_cast<std::uint16_t>(sizeof packet.direction));
  put(body, static_cast<std::uint32_t>(packet.direction));
  if (!packet.comment.empty()) {
    put_option(body, kComment, packet.comment);
  }
  return framed(kEnhancedPacketBlock, std::move(body));
}

}  // namespace ex9000::sim::pcapng
