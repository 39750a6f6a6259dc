#include "sim/front_ends/modbus_tcp/mbap.hpp"

namespace ex9000::sim {

namespace {

constexpr std::size_t kTransaction = 0;
constexpr std::size_t kProtocol = 2;
constexpr std::size_t kLength = 4;  ///< position of the length, which is the number of bytes after it
constexpr std::size_t kUnit = 6;
constexpr std::size_t kPdu = 7;
constexpr std::size_t kLeastLength = 2;  ///< the unit and a function code
constexpr std::size_t kMostLength = 254;

void put_word(std::vector<std::uint8_t>& bytes, std::size_t word) {
  bytes.push_back(static_cast<std::uint8_t>(word >> 8U));
  bytes.push_back(static_cast<std::uint8_t>(word));
}

}  // namespace

void MbapReader::add(Bytes bytes) { bytes_.insert(bytes_.end(), bytes.begin(), bytes.end()); }

std::optional<MbapFrame> MbapReader::next() {
  if (broken_ || bytes_.size() < kUnit) {
    return std::nullopt;
  }
  const Bytes bytes{bytes_.data(), bytes_.size()};
  const std::size_t length = bytes.word(kLength);
  if (bytes.word(kProtocol) != 0 || length < kLeastLength || length > kMostLength) {
    broken_ = true;
    return std::nullopt;
  }
  const std::size_t end = kUnit + length;
  if (bytes_.size() < end) {
    return std::nullopt;
  }
  const Bytes pdu = bytes.first(end).from(kPdu);
  MbapFrame frame{bytes.word(kTransaction), bytes[kUnit], {pdu.begin(), pdu.end()}};
  bytes_.erase(bytes_.begin(), bytes_.begin() + static_cast<std::ptrdiff_t>(end));
  return frame;
}

std::vector<std::uint8_t> mbap_bytes(const MbapFrame& frame) {
  std::vector<std::uint8_t> bytes;
  put_word(bytes, frame.transaction);
  put_word(bytes, 0);
  put_word(bytes, frame.pdu.size() + 1);
  bytes.push_back(frame.unit);
  bytes.insert(bytes.end(), frame.pdu.begin(), frame.pdu.end());
  return bytes;
}

}  // namespace ex9000::sim
