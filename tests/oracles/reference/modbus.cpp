// Modbus RTU of the reference, wire.md 7: whole frames and the dispatch to functions.
#include <algorithm>

#include "tests/oracles/reference/hexadecimal.hpp"
#include "tests/oracles/reference/modbus_check.hpp"
#include "tests/oracles/reference/modbus_refusal.hpp"
#include "tests/oracles/reference/module.hpp"

namespace ex9000::reference {

namespace {

constexpr unsigned kHostOk = 0x3038;

bool known_function(const ModelRow& model, unsigned function) {
  const Bytes known = {0x01, 0x03, 0x04, 0x05, 0x06, 0x08, 0x0F, 0x10, 0x11, 0x2B, 0x46};
  return std::find(known.begin(), known.end(), function) != known.end() ||
         (function == 0x02 && model.inputs != 0);
}

}  // namespace

/// extensions.md, scan: `FD 46 08`, a serial number other than 0, and at least a function.
bool Module::is_by_number(const Bytes& frame) {
  return frame.size() >= 8 && frame[0] == 0xFD && frame[1] == 0x46 && frame[2] == 0x08 &&
         (word(frame, 3) | word(frame, 5)) != 0;
}

/// Processes a complete frame of any content. Returns the reply with its CRC, or no bytes if there is no
/// reply. The counters of function 08 follow wire.md D1: for example, a frame of less than 4 bytes counts as
/// a CRC error, and a broadcast counts as a message without a reply. `bad`: which bytes have a line error.
Bytes Module::modbus_frame(Bytes frame, std::vector<bool> bad) {
  const auto spoiled = [&] { return std::find(bad.begin(), bad.end(), true) != bad.end(); };
  // A 00 from a line turn-around before a frame does not spoil the frame, even if the 00 has a line error.
  if (frame.size() > 4 && (spoiled() || !crc_is_right(frame)) && frame[0] == 0x00) {
    // The specification does not say whether a frame of 256 bytes may have a turn-around 00 before it.
    if (frame.size() <= 256 || choice(2) == 0) {
      frame.erase(frame.begin());
      bad.erase(bad.begin());
    }
  }
  if (spoiled()) {
    count(&Counts::crc_errors);
    return {};
  }
  // A frame has 4 to 256 bytes.
  if (frame.size() < 4) {
    count(&Counts::crc_errors);
    return {};
  }
  if (frame.size() > 256) {
    count(&Counts::crc_errors);
    return {};
  }
  if (!crc_is_right(frame)) {
    count(&Counts::crc_errors);
    return {};
  }
  frame.resize(frame.size() - 2);
  count(&Counts::bus_messages);
  Bytes prefix;
  const bool by_number = is_by_number(frame) && (word(frame, 3) << 16 | word(frame, 5)) == serial_number();
  if (by_number) {
    prefix = {0xFD, 0x46, 0x09, frame[3], frame[4], frame[5], frame[6]};
    frame.erase(frame.begin(), frame.begin() + 6);
    frame[0] = static_cast<std::uint8_t>(address_);
  }
  const unsigned address = frame[0];
  const unsigned function = frame[1];
  if (address != 0 && address != address_) {
    return {};
  }
  if (function >= 0x80) {
    return {};
  }
  count(&Counts::server_messages);
  own_ = address != 0;
  // A host OK is recognised first and never gets a reply.
  if ((function == 0x03 || function == 0x04) && frame.size() == 6 && word(frame, 2) == kHostOk &&
      word(frame, 4) <= 1) {
    counts_.no_response += 1;
    restart_host_watchdog();
    return {};
  }
  if (address == 0) {
    counts_.no_response += 1;
    const bool executed = function == 0x05 || function == 0x0F || function == 0x06 || function == 0x10;
    if (!executed) {
      return {};
    }
  }
  Bytes reply;
  try {
    reply = modbus_function(frame);
  } catch (const Exception& exception) {
    if (address != 0) {
      // wire.md D1: sub-function 0D counts only exceptions that the module has returned. A broadcast gets
      // none.
      counts_.exceptions += 1;
    }
    refusal_ = exception.reason;
    reply = {frame[0], static_cast<std::uint8_t>(function | 0x80U), exception.code};
  }
  if (by_number) {
    reply.erase(reply.begin());
    reply.insert(reply.begin(), prefix.begin(), prefix.end());
  }
  return address == 0 ? Bytes{} : with_crc(reply);
}

Bytes Module::modbus_function(const Bytes& frame) {
  const unsigned function = frame[1];
  if (!known_function(*row_, function)) {
    throw Exception{0x01, function == 0x02 ? "FC02 on a model without inputs" : "unknown function"};
  }
  switch (function) {
    case 0x01:
    case 0x02:
      return read_bits(frame);
    case 0x03:
    case 0x04:
      return read_registers(frame);
    case 0x05:
      return write_coil(frame);
    case 0x06:
      return write_register(frame);
    case 0x08:
      return diagnostics(frame);
    case 0x0F:
      return write_coils(frame);
    case 0x10:
      return write_registers(frame);
    case 0x11:
      return server_id(frame);
    case 0x2B:
      return device_identification(frame);
    default:
      return function_46(frame);
  }
}

}  // namespace ex9000::reference
