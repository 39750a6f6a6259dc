#include "sim/utility/command/send.hpp"

#include <algorithm>

#include "sim/line_monitor/frames/frame_meaning.hpp"
#include "sim/text/values.hpp"
#include "sim/utility/master_line/master_line.hpp"
#include "sim/utility/master_line/raw_exchange.hpp"
#include "sim/utility/modbus/module.hpp"

namespace ex9000::utility {

namespace {

constexpr std::size_t kCrcBytes = 2;

bool is_dcon(const std::string& text) { return std::string("#$%@~").find(text[0]) != std::string::npos; }

Data frame_of(const std::string& text, bool checksum) {
  if (is_dcon(text)) {
    return dcon_frame(text, checksum);
  }
  Data frame = sim::parse_hex_bytes(text);
  if (frame.size() < 2) {
    sim::fail("'" + text +
              "': expected a DCON command, as $01M, or an address and a function in hex, as 01 11");
  }
  append_crc(frame);
  return frame;
}

bool is_broadcast(const Data& frame) { return sim::looks_like_dcon(frame) ? frame[1] == '*' : frame[0] == 0; }

/// As on a line, with a CRC.
Data reply_of_gateway(Master& master, const Data& frame) {
  const Data pdu = master.exchange(
      at_address(frame[0]), any_reply({frame.begin() + 1, frame.end() - kCrcBytes}), Module::kPatience);
  if (pdu.empty()) {
    return {};
  }
  Data reply(1 + pdu.size(), frame[0]);
  std::copy(pdu.begin(), pdu.end(), reply.begin() + 1);
  append_crc(reply);
  return reply;
}

void print(Environment& environment, const char* direction, const Data& frame, sim::Speaker speaker) {
  const std::string meaning = sim::meaning(frame, speaker);
  environment.output << direction << " " << sim::shown(frame) << (meaning.empty() ? "" : "  ; " + meaning)
                     << std::endl;
}

}  // namespace

bool send(Environment& environment, const sim::Words& args, const Options& options) {
  const Port port = parse_port(args[0]);
  const std::string text = sim::joined({args.begin() + 1, args.end()});
  const Data frame = frame_of(text, options.checksum);
  if (port.kind == Port::Kind::ModbusTcp && is_dcon(text)) {
    sim::fail("'" + text + "': Modbus TCP carries no DCON; name another port");
  }
  MasterLine line(environment, port, options.line);
  print(environment, ">", frame, sim::Speaker::Master);
  Data reply;
  if (line.carries_all()) {
    reply = raw_exchange(line.connection(), frame, Module::kPatience, false).bytes;
  } else {
    reply = reply_of_gateway(line.modbus(), frame);
  }
  if (!reply.empty()) {
    print(environment, "<", reply, sim::Speaker::Module);
  } else if (is_broadcast(frame)) {
    environment.output << "no reply, as always to all modules" << std::endl;
  } else {
    environment.error << "ex9000: no reply" << std::endl;
  }
  return !reply.empty() || is_broadcast(frame);
}

}  // namespace ex9000::utility
