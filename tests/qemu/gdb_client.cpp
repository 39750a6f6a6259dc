#include "tests/qemu/gdb_client.hpp"

#include <array>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string_view>

namespace ex9000::rig {

namespace {

constexpr std::size_t kChecksum = 2;  ///< characters of the checksum after `#`

struct Packet {
  std::size_t begin;  ///< position of `$`
  std::size_t end;    ///< position of `#`
};

/// Returns the first packet. Returns no value if the packet or its checksum is incomplete.
std::optional<Packet> find_packet(std::string_view received) {
  const std::size_t begin = received.find('$');
  const std::size_t end = begin == std::string_view::npos ? begin : received.find('#', begin);
  if (end == std::string_view::npos || end + kChecksum >= received.size()) {
    return std::nullopt;
  }
  return Packet{begin, end};
}

}  // namespace

std::string GdbClient::framed(const std::string& packet) {
  constexpr std::array<char, 17> kDigits{"0123456789abcdef"};
  unsigned sum = 0;
  for (const char character : packet) {
    sum += static_cast<unsigned char>(character);
  }
  return "$" + packet + "#" + kDigits[sum / 16 % 16] + kDigits[sum % 16];
}

bool GdbClient::has_packet() {
  const std::vector<std::uint8_t> bytes = socket_.receive(std::chrono::nanoseconds(0));
  received_.append(bytes.begin(), bytes.end());
  return find_packet(received_).has_value();
}

std::string GdbClient::receive() {
  for (;;) {
    if (const std::optional<Packet> packet = find_packet(received_)) {
      std::string content = received_.substr(packet->begin + 1, packet->end - packet->begin - 1);
      received_.erase(0, packet->end + kChecksum + 1);
      return content;
    }
    const std::vector<std::uint8_t> bytes = socket_.receive(kHang);
    if (bytes.empty()) {
      throw std::runtime_error("gdb: the emulator has sent nothing for 60 s; expected a reply or a stop");
    }
    received_.append(bytes.begin(), bytes.end());
  }
}

}  // namespace ex9000::rig
