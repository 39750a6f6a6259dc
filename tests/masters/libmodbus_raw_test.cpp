// Tests the simulator with unmodified libmodbus, on one line with two modules. Sends the raw requests of
// tests/masters/conversation.txt, which include functions for which libmodbus has no call.
#include <gtest/gtest.h>
#include <modbus/modbus.h>
#include <poll.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "firmware/line/crc16.hpp"
#include "tests/masters/libmodbus_master.hpp"
#include "tests/support/hang.hpp"
#include "tests/support/two_modules.hpp"

namespace ex9000::system {
namespace {

/// The bytes of a frame without its CRC. The result of `received` or `heard` can also contain a CRC, be
/// incomplete, or be a header of Modbus TCP.
using Frame = std::vector<std::uint8_t>;

Frame frame_of(std::istringstream& hex) {
  Frame frame;
  for (std::string byte; hex >> byte && byte[0] != ';';) {
    frame.push_back(static_cast<std::uint8_t>(std::stoul(byte, nullptr, 16)));
  }
  return frame;
}

void send(LibmodbusMaster& master, const Frame& frame) {
  ASSERT_GT(modbus_send_raw_request(master.at(frame[0]), frame.data(), static_cast<int>(frame.size())), 0);
}

/// Returns the bytes received until there are `size` bytes, until no byte arrives for `patience`, or until
/// the connection fails. Reads the descriptor directly, because libmodbus cannot calculate the length of
/// replies to functions for which it has no call.
Frame received(LibmodbusMaster& master, std::size_t size, std::chrono::milliseconds patience) {
  Frame bytes;
  pollfd ready{modbus_get_socket(master.at(1)), POLLIN, 0};
  while (bytes.size() < size && poll(&ready, 1, static_cast<int>(patience.count())) == 1) {
    std::uint8_t byte = 0;
    if (read(ready.fd, &byte, 1) != 1) {
      break;
    }
    bytes.push_back(byte);
  }
  return bytes;
}

bool uses_modbus_tcp(LibmodbusMaster& master) { return modbus_get_header_length(master.at(1)) > 1; }

/// Receives `size` bytes and a CRC. Removes the CRC if it is correct, and returns the bytes. With Modbus TCP,
/// there is no CRC, and the header determines the number of bytes. In this case, the function returns the
/// bytes after the header, or an incomplete header. libmodbus checks the header in the tests of
/// libmodbus_test.cpp.
Frame heard(LibmodbusMaster& master, std::size_t size, std::chrono::milliseconds patience) {
  constexpr std::size_t kHeader = 6;  // bytes before the unit
  constexpr std::size_t kLength = 5;  // the low byte of the number of bytes after the header
  if (uses_modbus_tcp(master)) {
    const Frame header = received(master, kHeader, patience);
    return header.size() < kHeader ? header : received(master, header[kLength], patience);
  }
  Frame frame = received(master, size + 2, patience);
  if (frame.size() >= 2 && crc16({frame.data(), frame.size()}).value() == 0) {
    frame.resize(frame.size() - 2);
  }
  return frame;
}

/// Returns the frame in the format of the simulator's log, without its CRC.
std::string logged(const Frame& frame) {
  std::ostringstream text;
  text << "master " << std::hex << std::uppercase << std::setfill('0');
  for (const unsigned byte : frame) {
    text << ' ' << std::setw(2) << byte;
  }
  return text.str();
}

class LibmodbusRaw : public testing::TestWithParam<Way> {};

TEST_P(LibmodbusRaw, GetsEveryExpectedReplyOfTheConversation) {
  using std::chrono::milliseconds;
  TwoModules modules(GetParam());
  const bool over_modbus_tcp = GetParam().port == Way::ModbusTcp;
  LibmodbusMaster master = over_modbus_tcp ? LibmodbusMaster(modules.modbus_tcp_port())
                                           : LibmodbusMaster(modules.tty(), GetParam().baud);
  ASSERT_EQ(uses_modbus_tcp(master), over_modbus_tcp);
  const std::string rate_code = GetParam().baud == 9600 ? "06" : "0A";
  std::ifstream conversation(EX9000_CONVERSATION);
  int answers = 0;
  Frame sent;
  for (std::string line; std::getline(conversation, line);) {
    if (const auto at = line.find("{BAUD}"); at != std::string::npos) {
      line.replace(at, std::string("{BAUD}").size(), rate_code);
    }
    std::istringstream words(line);
    std::string what;
    words >> what;
    if (what == "gateway") {
      if (!over_modbus_tcp) {
        continue;
      }
      words >> what;
    }
    if (what == "=>") {
      sent = frame_of(words);
      send(master, sent);
    } else if (what == "<=") {
      const Frame expected = frame_of(words);
      EXPECT_EQ(heard(master, expected.size(), kHang), expected) << line;
      ++answers;
    } else if (what == "silence") {
      // The line runs in real time. If the next request came before the simulator has read this one, both
      // would form one frame on a serial line. On a busy machine, a wrong reply can arrive after this check.
      // The test then receives this reply instead of the reply to the next request, and fails at that
      // request.
      ASSERT_TRUE(modules.simulator().wait_for(logged(sent))) << line;
      EXPECT_EQ(heard(master, 1, milliseconds(300)), Frame{}) << line;
    } else if (what == "wait") {
      int time = 0;
      words >> time;
      // The line runs in real time, so the same time passes for the modules.
      std::this_thread::sleep_for(milliseconds(time));
    } else {
      EXPECT_TRUE(what.empty() || what[0] == ';') << line;
    }
  }
  EXPECT_GT(answers, 100);
}

INSTANTIATE_TEST_SUITE_P(Ways, LibmodbusRaw,
                         testing::Values(Way{Way::Pty, 9600}, Way{Way::Pty, 115200}, Way{Way::Tcp, 115200},
                                         Way{Way::ModbusTcp, 115200}));

}  // namespace
}  // namespace ex9000::system
