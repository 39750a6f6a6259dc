#include "sim/utility/modbus/addressee.hpp"

#include "firmware/line/rtu_frames.hpp"
#include "firmware/settings/settings.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"

namespace ex9000::utility {

Addressee at_address(std::uint8_t address) { return {std::to_string(address), {address}, {address}}; }

Addressee with_serial_number(std::uint32_t number) {
  Addressee to{sim::hex_long_text(number), {modbus::kScanAddress, modbus::kScanFunction}, {}};
  to.reply = to.request;
  to.request.push_back(modbus::kRequestByNumber);
  to.reply.push_back(modbus::kReplyByNumber);
  for (const std::uint8_t byte : sim::parse_hex_bytes(to.name)) {
    to.request.push_back(byte);
    to.reply.push_back(byte);
  }
  return to;
}

Addressee parse_addressee(const std::string& text) {
  constexpr std::size_t kDigits = 8;
  constexpr int kHex = 16;
  if (text.size() == kDigits && text.find_first_not_of("0123456789ABCDEFabcdef") == std::string::npos) {
    return with_serial_number(static_cast<std::uint32_t>(std::stoul(text, nullptr, kHex)));
  }
  const auto address = sim::whole_number(text, kLastModbusAddress);
  if (!address || *address < kFirstModbusAddress) {
    sim::fail("'" + text + "': expected an address from 1 to 247, or a serial number of 8 hex digits");
  }
  return at_address(static_cast<std::uint8_t>(*address));
}

}  // namespace ex9000::utility
