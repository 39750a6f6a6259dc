#include "sim/line_monitor/capture/upper_pdu.hpp"

namespace ex9000::sim {

namespace {

// From Wireshark's exported_pdu_tlvs.h.
constexpr std::uint16_t kEndOfTags = 0;
constexpr std::uint16_t kDissectorName = 12;
constexpr std::uint16_t kPortType = 24;
constexpr std::uint16_t kSourcePort = 25;
constexpr std::uint16_t kDestinationPort = 26;
constexpr std::uint16_t kProtocolColumn = 33;
constexpr std::uint32_t kTcp = 2;

/// The lowest `bytes` bytes, big-endian.
void put(std::vector<std::uint8_t>& header, std::uint32_t number, unsigned bytes) {
  for (unsigned byte = bytes; byte-- != 0;) {
    header.push_back(static_cast<std::uint8_t>(number >> 8U * byte));
  }
}

void put_number(std::vector<std::uint8_t>& header, std::uint16_t tag, std::uint32_t number) {
  put(header, tag, 2);
  put(header, sizeof number, 2);
  put(header, number, sizeof number);
}

/// Padded with zeros to a multiple of four bytes, which the tag's length includes.
void put_text(std::vector<std::uint8_t>& header, std::uint16_t tag, std::string text) {
  text.resize((text.size() + 3) / 4 * 4);
  put(header, tag, 2);
  put(header, static_cast<std::uint32_t>(text.size()), 2);
  header.insert(header.end(), text.begin(), text.end());
}

}  // namespace

std::vector<std::uint8_t> UpperPdu::header() const {
  std::vector<std::uint8_t> header;
  put_text(header, kDissectorName, dissector);
  put_number(header, kPortType, kTcp);
  put_number(header, kSourcePort, source_port);
  put_number(header, kDestinationPort, destination_port);
  put_text(header, kProtocolColumn, protocol);
  put_text(header, kEndOfTags, "");
  return header;
}

}  // namespace ex9000::sim
