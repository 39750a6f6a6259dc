// The frames of Modbus TCP (MODBUS Messaging on TCP/IP Implementation Guide V1.0b, 3.1.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/bytes.hpp"

namespace ex9000::sim {

/// Without the protocol and the length in the header.
struct MbapFrame {
  std::uint16_t transaction = 0;  ///< chosen by the client; a reply has the number of its request
  std::uint8_t unit = 0;          ///< address of the module; 0: all modules
  std::vector<std::uint8_t> pdu;  ///< 1 to 253 bytes: the function code and its data
};

/// TCP may split a frame into pieces, or join several.
class MbapReader {
 public:
  void add(Bytes bytes);
  /// nullopt: the next frame is not complete yet, or `broken`.
  std::optional<MbapFrame> next();
  /// A header had a wrong protocol or length: close the connection, because the start of the next frame is
  /// unknown. Frames before it are valid.
  [[nodiscard]] bool broken() const { return broken_; }
  /// Bytes that `next` has not returned yet.
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }

 private:
  std::vector<std::uint8_t> bytes_;
  bool broken_ = false;
};

std::vector<std::uint8_t> mbap_bytes(const MbapFrame& frame);

}  // namespace ex9000::sim
