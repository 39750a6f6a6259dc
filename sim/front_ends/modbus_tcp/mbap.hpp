// The frames of Modbus TCP (MODBUS Messaging on TCP/IP Implementation Guide V1.0b, 3.1.3).
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "firmware/bytes.hpp"

namespace ex9000::sim {

/// A request or a reply: the header without its protocol and its length, and the PDU.
struct MbapFrame {
  std::uint16_t transaction = 0;  ///< chosen by the client; a reply has the number of its request
  std::uint8_t unit = 0;          ///< address of the module; 0: all modules
  std::vector<std::uint8_t> pdu;  ///< 1 to 253 bytes: the function code and its data
};

/// Finds the frames in the bytes of a connection. TCP may split a frame into pieces, or join several frames.
class MbapReader {
 public:
  void add(Bytes bytes);
  /// Removes and returns the next frame; nullopt if this frame is not complete yet, or if `broken` is true.
  std::optional<MbapFrame> next();
  /// Returns whether `next` has found a header with a wrong protocol or length. In this case the start of the
  /// next frame is unknown, so the caller must close the connection. The frames before this header are valid.
  [[nodiscard]] bool broken() const { return broken_; }
  /// Returns the number of bytes that `next` has not returned yet.
  [[nodiscard]] std::size_t size() const { return bytes_.size(); }

 private:
  std::vector<std::uint8_t> bytes_;
  bool broken_ = false;
};

std::vector<std::uint8_t> mbap_bytes(const MbapFrame& frame);

}  // namespace ex9000::sim
