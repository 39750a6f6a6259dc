#include "tests/sim/line_monitor/capture/tshark.hpp"

#include <gtest/gtest.h>

#include <sstream>

#include "tests/support/child_process.hpp"

namespace ex9000::system {

namespace {

/// Splits a line. The last part is empty if the line ends with the separator.
std::vector<std::string> split(const std::string& line, char separator) {
  std::vector<std::string> parts(1);
  for (const char character : line) {
    if (character == separator) {
      parts.emplace_back();
    } else {
      parts.back() += character;
    }
  }
  return parts;
}

}  // namespace

std::vector<Packet> decoded(const std::string& path, const std::vector<std::string>& fields) {
  std::vector<std::string> command{
      "tshark", "-r",     path, "-o",         "mbrtu.tcp.port:9000", "-o", "mbrtu.crc_verification:TRUE",
      "-T",     "fields", "-E", "separator=|"};
  for (const std::string& field : fields) {
    command.insert(command.end(), {"-e", field});
  }
  const Finished finished = run(command);
  EXPECT_EQ(finished.status, 0) << finished.error;
  // If the file is incomplete or damaged, tshark prints "appears to have been cut short" or "appears to be
  // damaged".
  EXPECT_EQ(finished.error.find("appears to"), std::string::npos) << finished.error;
  std::vector<Packet> packets;
  std::string line;
  for (std::istringstream lines(finished.output); std::getline(lines, line);) {
    const std::vector<std::string> values = split(line, '|');
    Packet packet;
    for (std::size_t i = 0; i < fields.size() && i < values.size(); ++i) {
      packet[fields[i]] = values[i];
    }
    packets.push_back(packet);
  }
  return packets;
}

void expect_shown(const Packet& packet, const Packet& wanted) {
  for (const auto& [field, value] : wanted) {
    EXPECT_EQ(packet.at(field), value) << field;
  }
}

}  // namespace ex9000::system
