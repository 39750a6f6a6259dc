// The header that names a frame's dissector, so that users need not choose one: LINKTYPE_WIRESHARK_UPPER_PDU,
// see https://wiki.wireshark.org/Protocols/exported_pdu.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::sim {

constexpr std::uint16_t kLinkTypeWiresharkUpperPdu = 252;

struct UpperPdu {
  std::string dissector;  ///< Wireshark's name of the dissector
  std::string protocol;   ///< text for the protocol column
  /// Wireshark takes a frame from mbrtu.tcp.port (kCapturedModulesPort) for a response, to it for a query.
  std::uint16_t source_port = 0;
  std::uint16_t destination_port = 0;

  [[nodiscard]] std::vector<std::uint8_t> header() const;
};

}  // namespace ex9000::sim
