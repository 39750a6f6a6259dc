#include "sim/app/running_line/hints.hpp"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "firmware/line/crc16.hpp"
#include "firmware/line/rtu_frames.hpp"
#include "sim/text/values.hpp"
#include "sim/virtual_line/line/rtu_frame.hpp"

namespace ex9000::sim {

namespace {

/// They are a request with the header of Modbus TCP, or begin with one.
bool looks_like_modbus_tcp(const FrameBytes& bytes) {
  constexpr std::size_t kHeader = 6;  // transaction, protocol, length
  constexpr std::size_t kLeast = 2;   // unit and function
  const Bytes all{bytes.data(), bytes.size()};
  return all.size >= kHeader + kLeast && all.word(2) == 0 && all.word(4) >= kLeast &&
         all.word(4) <= all.size - kHeader && crc16(all).value() != 0;
}

/// nullopt: no address, for example in ~**.
std::optional<std::uint8_t> dcon_address(const FrameBytes& bytes) {
  const auto begin = std::find_if(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte > ' '; });
  if (bytes.end() - begin < 4 || bytes.back() != '\r') {
    return std::nullopt;
  }
  try {
    return parse_hex_byte({begin + 1, begin + 3});
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

bool is_valid_rtu(const FrameBytes& bytes) {
  constexpr std::size_t kShortest = 4;
  return bytes.size() >= kShortest && crc16({bytes.data(), bytes.size()}).value() == 0;
}

std::string hint_for_address(const Line& line, Protocol protocol, std::uint8_t address) {
  const std::string name = protocol == Protocol::Ascii ? "ASCII" : "Modbus RTU";
  bool speaks = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const SimulatedModule& module = line.module(i);
    if (!module.powered() || !module.module().listening()) {
      return "";
    }
    const InForce& in_force = module.module().state().in_force;
    if (in_force.protocol == protocol) {
      speaks = true;
      if (in_force.address == address) {
        return "";
      }
    }
  }
  return speaks ? "no module that speaks " + name + " has the address " + hex_byte_text(address)
                : "no module speaks " + name + ", the protocol of this request";
}

}  // namespace

std::string hint_for(const Frame& frame, const Line& line) {
  const FrameBytes& bytes = frame.bytes;
  if (frame.speaker() != Speaker::Master || frame.collided || !frame.changes.empty()) {
    return "";
  }
  if (looks_like_dcon(bytes)) {
    const std::optional<std::uint8_t> address = dcon_address(bytes);
    return address ? hint_for_address(line, Protocol::Ascii, *address) : "";
  }
  if (looks_like_modbus_tcp(bytes)) {
    return "these bytes look like Modbus TCP; use --port modbus-tcp:PORT, or set the master to Modbus RTU "
           "over TCP";
  }
  if (!is_valid_rtu(bytes)) {
    return "";
  }
  const std::uint8_t address = bytes[0];
  if (address == modbus::kScanAddress && bytes[1] == modbus::kScanFunction) {
    return "";
  }
  if (address > kLastRtuAddress) {
    return "modules ignore the address " + hex_byte_text(address) + ", because F8 to FF are reserved";
  }
  if (address == kRtuBroadcast) {
    constexpr std::uint8_t kLastRead = 0x04;
    return bytes[1] <= kLastRead
               ? "modules ignore a read at address 00, because they do not reply to a broadcast"
               : "";
  }
  return hint_for_address(line, Protocol::ModbusRtu, address);
}

}  // namespace ex9000::sim
