// How Wireshark stores what it is to dissect without the layers below: LINKTYPE_WIRESHARK_UPPER_PDU, see
// https://wiki.wireshark.org/Protocols/exported_pdu. A serial line has no link type that carries who is
// asking and who answers; this one does, and it names the dissector, so that nobody has to set one up.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::sim {

constexpr std::uint16_t kLinkTypeWiresharkUpperPdu = 252;

/// What comes before the bytes of a frame.
struct UpperPdu {
  std::string dissector;  ///< Wireshark's name of it
  std::string protocol;   ///< what the protocol column shows; empty: what the dissector says
  /// The dissector for Modbus RTU takes what comes from its port for a response, and what goes there for a
  /// query.
  std::uint16_t source_port = 0;
  std::uint16_t destination_port = 0;

  [[nodiscard]] std::vector<std::uint8_t> header() const;
};

}  // namespace ex9000::sim
