// A master that sends the same request in ASCII or in Modbus RTU, to a module with address 01 and without a
// checksum.
#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "firmware/settings/settings.hpp"
#include "sim/app/play/modbus_frame.hpp"

namespace ex9000 {

class EitherProtocol {
 public:
  using Bytes = std::vector<std::uint8_t>;
  /// Sends a frame and returns the reply. Returns an empty vector if there is no reply.
  using Exchange = std::function<Bytes(const Bytes& frame)>;

  EitherProtocol(Protocol protocol, Exchange exchange)
      : protocol_(protocol), exchange_(std::move(exchange)) {}

  [[nodiscard]] bool ascii() const { return protocol_ == Protocol::Ascii; }

  /// Returns the request for the module's protocol: `text` with CR, or `modbus` with its CRC.
  [[nodiscard]] Bytes framed(const std::string& text, const Bytes& modbus) const {
    if (!ascii()) {
      return with_crc(modbus);
    }
    Bytes bytes(text.begin(), text.end());
    bytes.push_back('\r');
    return bytes;
  }
  Bytes ask(const std::string& text, const Bytes& modbus) { return exchange_(framed(text, modbus)); }

  // These functions throw std::out_of_range if the reply is too short.
  bool timeout_status() {
    const Bytes reply = ask("~010", {1, 0x01, 0x01, 0x0D, 0, 1});
    return ascii() ? reply.at(4) == '4' : reply.at(3) == 1;
  }
  bool enabled() {
    const Bytes reply = ask("~012", {1, 0x01, 0x01, 0x04, 0, 1});
    return ascii() ? reply.at(3) == '1' : reply.at(3) == 1;
  }
  /// Returns whether the module has been reset since the last call. In ASCII, sends `$AA5`. In Modbus, reads
  /// the bus message counter. The counter is 1 if the request that reads it is the first message after a
  /// reset. Therefore a Modbus test must send no other message between the reset and this call.
  bool was_reset() {
    const Bytes reply = ask("$015", {1, 0x08, 0, 0x0B, 0, 0});
    return ascii() ? reply.at(3) == '1' : (reply.at(4) << 8U | reply.at(5)) == 1;
  }

 private:
  Protocol protocol_;
  Exchange exchange_;
};

}  // namespace ex9000
