#include "tests/qemu/qtest_client.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>
#include <utility>

namespace ex9000::rig {

namespace {

std::string set_irq_in(const std::string& path, unsigned number, bool level) {
  return "set_irq_in " + path + " unnamed-gpio-in " + std::to_string(number) + (level ? " 1\n" : " 0\n");
}

std::string readl(std::uint32_t address) { return "readl " + std::to_string(address) + "\n"; }

}  // namespace

QtestClient::QtestClient(UnixSocket socket) : socket_(std::move(socket)) {}

/// Reads a reply. Returns the text after `OK`; throws std::runtime_error if the reply is an error.
std::string QtestClient::reply() {
  std::string line = socket_.receive_line();
  if (line.rfind("OK", 0) != 0) {
    throw std::runtime_error("qtest: the emulator replies " + line + "; expected OK");
  }
  return line.substr(2);
}

std::uint32_t QtestClient::value() { return static_cast<std::uint32_t>(std::stoull(reply(), nullptr, 16)); }

std::uint32_t QtestClient::read(std::uint32_t address) {
  socket_.send(readl(address));
  return value();
}

std::vector<std::uint32_t> QtestClient::read(const std::vector<std::uint32_t>& addresses) {
  std::string commands;
  for (const std::uint32_t address : addresses) {
    commands += readl(address);
  }
  socket_.send(commands);
  std::vector<std::uint32_t> values;
  for (std::size_t i = 0; i < addresses.size(); ++i) {
    values.push_back(value());
  }
  return values;
}

std::vector<std::uint8_t> QtestClient::read(std::uint32_t address, std::uint32_t size) {
  constexpr std::size_t kLead = 3;  // a space and 0x
  constexpr int kHex = 16;
  socket_.send("read " + std::to_string(address) + " " + std::to_string(size) + "\n");
  const std::string hex = reply();
  std::vector<std::uint8_t> bytes;
  for (std::size_t at = kLead; at + 2 <= hex.size(); at += 2) {
    bytes.push_back(static_cast<std::uint8_t>(std::stoul(hex.substr(at, 2), nullptr, kHex)));
  }
  return bytes;
}

void QtestClient::write(std::uint32_t address, std::uint32_t value) {
  carry_out(write_command(address, value));
}

void QtestClient::write(std::uint32_t address, const std::vector<std::uint8_t>& bytes) {
  constexpr std::array<char, 17> kDigits{"0123456789ABCDEF"};
  std::string hex;
  for (const std::uint8_t byte : bytes) {
    hex += {kDigits[byte / 16], kDigits[byte % 16]};
  }
  carry_out("write " + std::to_string(address) + " " + std::to_string(bytes.size()) + " 0x" + hex + "\n");
}

std::string QtestClient::write_command(std::uint32_t address, std::uint32_t value) {
  return "writel " + std::to_string(address) + " " + std::to_string(value) + "\n";
}

void QtestClient::carry_out(const std::string& commands) {
  socket_.send(commands);
  for (auto left = std::count(commands.begin(), commands.end(), '\n'); left != 0; --left) {
    reply();
  }
}

void QtestClient::fill(std::uint32_t address, std::uint32_t size, std::uint8_t byte) {
  socket_.send("memset " + std::to_string(address) + " " + std::to_string(size) + " " + std::to_string(byte) +
               "\n");
  reply();
}

void QtestClient::set_input(const std::string& path, unsigned number, bool level) {
  socket_.send(set_irq_in(path, number, level));
  reply();
}

}  // namespace ex9000::rig
