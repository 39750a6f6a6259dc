// Tests the messages that the program prints if the host gives it no processor time for a while, or if the
// program reads two requests in one piece.
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <string>
#include <thread>
#include <vector>

#include "firmware/line/crc16.hpp"
#include "sim/text/durations.hpp"
#include "tests/support/simulator_process.hpp"
#include "tests/support/socket_client.hpp"

namespace ex9000::system {
namespace {

/// Stops the process for at least `span`.
void suspend(int pid, std::chrono::milliseconds span) {
  kill(pid, SIGSTOP);
  int status = 0;
  ASSERT_EQ(waitpid(pid, &status, WUNTRACED), pid);
  ASSERT_TRUE(WIFSTOPPED(status));
  std::this_thread::sleep_for(span);  // the test requires this delay; the sleep does not wait for an event
  kill(pid, SIGCONT);
}

/// Returns a request with function 01 for coil 0 of the module at `address`.
std::vector<std::uint8_t> request(std::uint8_t address) {
  std::vector<std::uint8_t> frame{address, 1, 0, 0, 0, 1};
  const Crc16 crc = crc16({frame.data(), frame.size()});
  frame.push_back(crc.low_byte());
  frame.push_back(crc.high_byte());
  return frame;
}

std::string text_of(const std::vector<std::uint8_t>& bytes) { return {bytes.begin(), bytes.end()}; }

/// Returns the longest delay that the log reports; 0 if the log reports none.
hal::doubles::VirtualTime longest_delay(const std::string& log) {
  const std::string lead = "the host was late by ";
  hal::doubles::VirtualTime longest{0};
  for (auto at = log.find(lead); at != std::string::npos; at = log.find(lead, at + 1)) {
    const auto begin = at + lead.size();
    longest = std::max(longest, sim::parse_time(log.substr(begin, log.find(':', begin) - begin)));
  }
  return longest;
}

TEST(LateHost, ALateHostIsReportedWithItsDelay) {
  // With a changing input, the next event is always due soon.
  SimulatorProcess simulator({"EX9052D@01,input=0 square 10ms", "--port", "tcp:0"});
  SocketClient client(simulator.tcp_port());
  client.send("$01M\r");
  ASSERT_EQ(client.receive_text(8), "!019052\r");  // the line runs
  suspend(simulator.pid(), std::chrono::milliseconds(300));
  // An event is due every 5 ms, so the program is late by at least 295 ms when it continues. It reports a
  // delay only if that delay is at least twice the longest delay that it has reported before. If the program
  // does not report this delay, a busy host has caused an earlier report, which states a delay of at least
  // 147 ms.
  for (unsigned reports = 1; longest_delay(simulator.output()) < std::chrono::milliseconds(147); ++reports) {
    ASSERT_TRUE(simulator.wait_for(": modules reply later", reports)) << simulator.output();
  }
}

TEST(LateHost, TwoRequestsThatAreReadInOnePieceAreReported) {
  SimulatorProcess simulator({"EX9042D-M@01,protocol=modbus", "--port", "tcp:0", "--log"});
  SocketClient client(simulator.tcp_port());
  client.send(text_of(request(1)));
  EXPECT_EQ(client.receive_text(6).substr(0, 3), std::string("\x01\x01\x01", 3));
  ASSERT_TRUE(simulator.wait_for("Read Coils, reply")) << simulator.output();
  EXPECT_EQ(simulator.output().find("read in one piece"), std::string::npos) << simulator.output();
  client.send(text_of(request(2)) + text_of(request(1)));
  EXPECT_TRUE(simulator.wait_for("two Modbus frames were read in one piece"));
}

}  // namespace
}  // namespace ex9000::system
