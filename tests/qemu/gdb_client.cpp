#include "tests/qemu/gdb_client.hpp"

#include <array>
#include <stdexcept>

namespace ex9000::rig {

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
  const std::size_t begin = received_.find('$');
  constexpr std::size_t kChecksum = 2;
  return begin != std::string::npos && received_.find('#', begin) + kChecksum < received_.size();
}

std::string GdbClient::receive() {
  constexpr std::size_t kChecksum = 2;
  for (;;) {
    const std::size_t begin = received_.find('$');
    const std::size_t end = received_.find('#', begin == std::string::npos ? 0 : begin);
    if (begin != std::string::npos && end != std::string::npos && end + kChecksum < received_.size()) {
      std::string packet = received_.substr(begin + 1, end - begin - 1);
      received_.erase(0, end + kChecksum + 1);
      return packet;
    }
    const std::vector<std::uint8_t> bytes = socket_.receive(kHang);
    if (bytes.empty()) {
      throw std::runtime_error("gdb: the emulator has sent nothing for 60 s; expected a reply or a stop");
    }
    received_.append(bytes.begin(), bytes.end());
  }
}

}  // namespace ex9000::rig
