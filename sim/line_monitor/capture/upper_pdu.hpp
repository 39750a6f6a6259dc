// The header that lets Wireshark dissect a frame without the layers below it: LINKTYPE_WIRESHARK_UPPER_PDU,
// see https://wiki.wireshark.org/Protocols/exported_pdu. The header names the dissector, so that users need
// not choose one.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace ex9000::sim {

constexpr std::uint16_t kLinkTypeWiresharkUpperPdu = 252;

/// The header before the bytes of a frame.
struct UpperPdu {
  std::string dissector;  ///< Wireshark's name of the dissector
  std::string protocol;   ///< text for the protocol column
  /// Wireshark's preference mbrtu.tcp.port names a port, see kCapturedModulesPort. The dissector for Modbus
  /// RTU treats a frame from this port as a response, and a frame to this port as a query.
  std::uint16_t source_port = 0;
  std::uint16_t destination_port = 0;

  [[nodiscard]] std::vector<std::uint8_t> header() const;
};

}  // namespace ex9000::sim
