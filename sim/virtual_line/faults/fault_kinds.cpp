#include <algorithm>
#include <numeric>

#include "firmware/line/crc16.hpp"
#include "firmware/line/rtu_frames.hpp"
#include "sim/text/values.hpp"
#include "sim/virtual_line/faults/fault.hpp"

namespace ex9000::sim {

namespace {

using Value = FaultKind::Value;
using Lasts = FaultKind::Lasts;

template <double NoiseRates::*rate>
void disturb(const Fault& fault, LineFaults& line) {
  line.noise.*rate = std::max(line.noise.*rate, fault.probability);
}

void echo(const Fault& fault, LineFaults& line) { line.echo_after = fault.time; }

void send_foreign(const Fault& fault, LineFaults& line) {
  line.foreign_bytes.insert(line.foreign_bytes.end(), fault.bytes.begin(), fault.bytes.end());
}

void lose(const Fault& /*fault*/, Reply& reply, const State& /*state*/) { reply.lost = true; }

void delay(const Fault& fault, Reply& reply, const State& /*state*/) {
  reply.late_by = fault.time;
  reply.delayed_by = fault.number;
}

void end_with_crc(std::vector<std::uint8_t>& frame) {
  const Crc16 crc = crc16({frame.data(), frame.size()});
  frame.insert(frame.end(), {crc.low_byte(), crc.high_byte()});
}

void end_with_cr(std::string text, const State& state, std::vector<std::uint8_t>& frame) {
  if (state.in_force.checksum) {
    text += hex_byte_text(std::accumulate(text.begin(), text.end(), 0U));
  }
  text += '\r';
  frame.assign(text.begin(), text.end());
}

/// Of the address, or of what stands for it in a reply by serial number (extensions.md, scan).
std::size_t address_at(const std::vector<std::uint8_t>& reply) {
  const bool by_number = reply.size() > modbus::kNumberPrefix + 2 && reply[0] == modbus::kScanAddress &&
                         reply[1] == modbus::kScanFunction && reply[2] == modbus::kReplyByNumber;
  return by_number ? modbus::kNumberPrefix : 0;
}

/// MODBUS Application Protocol V1.1b3, section 7; in ASCII a rejection.
void refuse(const Fault& fault, Reply& reply, const State& state) {
  constexpr unsigned kException = 0x80;
  if (state.speaks_modbus()) {
    reply.bytes.resize(address_at(reply.bytes) + 2);
    reply.bytes.back() |= kException;
    reply.bytes.push_back(fault.bytes[0]);
    end_with_crc(reply.bytes);
  } else {
    end_with_cr("?" + hex_byte_text(state.in_force.address), state, reply.bytes);
  }
}

/// ASCII replies have an address after `!` or `?`, but not the bare `!` and `?`, nor `>` (wire.md section 3).
void answer_as(const Fault& fault, Reply& reply, const State& state) {
  constexpr std::ptrdiff_t kCheck = 2;  // bytes of the CRC, characters of the checksum
  auto& bytes = reply.bytes;
  if (state.speaks_modbus()) {
    bytes[address_at(bytes)] = fault.bytes[0];
    bytes.erase(bytes.end() - kCheck, bytes.end());
    end_with_crc(bytes);
    return;
  }
  const std::string text(bytes.begin(), bytes.end() - 1 - (state.in_force.checksum ? kCheck : 0));
  if (text[0] != '>' && text.size() >= 3) {
    end_with_cr(text[0] + hex_byte_text(fault.bytes[0]) + text.substr(3), state, bytes);
  }
}

void hold_driver(const Fault& fault, ModuleFaults& module) { module.driver_late_by = fault.time; }

void change_rate(const Fault& fault, ModuleFaults& module) { module.rate = fault.rate; }

void cut_supply(const Fault& /*fault*/, ModuleFaults& module) { module.no_supply = true; }

void hang(const Fault& /*fault*/, ModuleFaults& module) { module.hangs = true; }

void spoil_images(const Fault& /*fault*/, ModuleFaults& module) { module.bad_images = true; }

}  // namespace

const std::vector<FaultKind>& fault_kinds() {
  static const std::vector<FaultKind> kinds{
      {"bit-errors", Value::Probability, "1e-4", Lasts::Open, disturb<&NoiseRates::flipped_bit>,
       "inverts each bit with this probability"},
      {"lost-bytes", Value::Probability, "0.01", Lasts::Open, disturb<&NoiseRates::lost_character>,
       "drops each byte with this probability"},
      {"inserted-bytes", Value::Probability, "0.01", Lasts::Open, disturb<&NoiseRates::stray_character>,
       "after each byte, adds a random byte with this probability"},
      {"echo", Value::Pause, "5ms", Lasts::Open, echo,
       "sends received bytes again after a pause of this length"},
      {"foreign-traffic", Value::Bytes, "0501000000083C48 every 1s", Lasts::Moment, send_foreign,
       "makes a foreign sender send these bytes"},
      {"lost-reply", Value::None, "every 3rd reply", Lasts::Reply, lose, "drops the reply"},
      {"late-reply", Value::Time, "50ms", Lasts::Reply, delay, "delays the reply by this time"},
      {"exception", Value::Byte, "06 every 3rd reply", Lasts::Reply, refuse,
       "replaces the reply by an exception with this code; in ASCII by ?AA"},
      {"wrong-unit", Value::Byte, "7F every 3rd reply", Lasts::Reply, answer_as,
       "makes the reply carry this address"},
      {"late-driver", Value::Time, "2ms", Lasts::Reply, hold_driver,
       "keeps the driver enabled for this time after the reply"},
      {"wrong-rate", Value::Rate, "19200", Lasts::Open, change_rate,
       "makes the module receive and send at this rate"},
      {"gone", Value::None, "", Lasts::Open, cut_supply, "switches the supply off until the fault ends"},
      {"power-cut", Value::None, "every 10s", Lasts::Second, cut_supply,
       "cuts the supply, for 1s by default"},
      {"hang", Value::None, "every 10s", Lasts::Moment, hang,
       "stops the main loop until the module watchdog resets the module"},
      {"bad-image", Value::None, "", Lasts::Open, spoil_images,
       "makes each image of an update hang when it starts, so the module takes it back"},
  };
  return kinds;
}

}  // namespace ex9000::sim
