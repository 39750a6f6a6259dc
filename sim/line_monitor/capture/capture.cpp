#include "sim/line_monitor/capture/capture.hpp"

#include "firmware/model/model.hpp"
#include "sim/line_monitor/capture/pcapng.hpp"
#include "sim/line_monitor/capture/upper_pdu.hpp"
#include "sim/line_monitor/frames/frame_errors.hpp"
#include "sim/line_monitor/frames/frame_meaning.hpp"

namespace ex9000::sim {

namespace {

UpperPdu dissected_by(const Frame& frame) {
  constexpr std::size_t kShortestThatMbrtuTakes = 5;
  if (was_dcon(frame.bytes)) {
    return {"data-text-lines", "DCON"};
  }
  // Wireshark's protocol column shows `Modbus RTU` even if the dissector cannot decode the frame.
  return {frame.bytes.size() < kShortestThatMbrtuTakes ? "data" : "mbrtu", "Modbus RTU"};
}

}  // namespace

void Capture::begin() {
  file_.begin();
  file_.append(pcapng::section_header("ex9000-sim " + std::string(kFirmwareVersion)));
}

std::size_t Capture::add_line(const std::string& name, std::size_t modules, std::chrono::nanoseconds began) {
  file_.append(pcapng::interface_description(kLinkTypeWiresharkUpperPdu, name));
  lines_.push_back({modules, began});
  return lines_.size() - 1;
}

void Capture::write(std::size_t line, const Frame& frame) {
  // Wireshark matches replies with requests by their ports, so the master of each line has its own. Ports 0:
  // a station that is neither master nor module may send both.
  constexpr std::size_t kFirstMastersPort = 10000;
  const auto master = static_cast<std::uint16_t>(kFirstMastersPort + line);
  const bool known = frame.station <= lines_[line].modules;
  UpperPdu pdu = dissected_by(frame);
  pcapng::EnhancedPacket packet;
  if (frame.speaker() == Speaker::Master) {
    pdu.source_port = master;
    pdu.destination_port = kCapturedModulesPort;
    packet.direction = pcapng::Direction::Outbound;
  } else if (known) {
    pdu.source_port = kCapturedModulesPort;
    pdu.destination_port = master;
  }
  packet.interface_id = static_cast<std::uint32_t>(line);
  packet.timestamp = lines_[line].began + frame.began;
  packet.data = pdu.header();
  packet.data.insert(packet.data.end(), frame.bytes.begin(), frame.bytes.end());
  packet.comment = known ? errors(frame) : line_error(frame);  // as in the logs
  file_.append(pcapng::enhanced_packet(packet));
}

}  // namespace ex9000::sim
