// Tests Modbus TCP in the program: the option --modbus-tcp, and the key `modbus-tcp` of a bus file. A test
// whose result depends on times uses stepped time (--speed step).
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/support/control_client.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/simulator_process.hpp"
#include "tests/support/socket_client.hpp"

namespace ex9000::system {
namespace {

using Buffer = std::vector<std::uint8_t>;

/// Transactions 1 and 2 read the outputs of unit 1.
const Buffer kFirst{0x00, 0x01, 0x00, 0x00, 0x00, 0x06, 0x01, 0x01, 0x00, 0x00, 0x00, 0x0D};
const Buffer kSecond{0x00, 0x02, 0x00, 0x00, 0x00, 0x06, 0x01, 0x01, 0x00, 0x00, 0x00, 0x0D};
const Buffer kFirstReply{0x00, 0x01, 0x00, 0x00, 0x00, 0x05, 0x01, 0x01, 0x02, 0x00, 0x00};
const Buffer kSecondReply{0x00, 0x02, 0x00, 0x00, 0x00, 0x05, 0x01, 0x01, 0x02, 0x00, 0x00};
/// Transaction 3 reads the outputs of unit 9, which exists only in EachLineOfABusFileCanHaveAGateway.
const Buffer kToNobody{0x00, 0x03, 0x00, 0x00, 0x00, 0x06, 0x09, 0x01, 0x00, 0x00, 0x00, 0x0D};
const Buffer kNoReply{0x00, 0x03, 0x00, 0x00, 0x00, 0x03, 0x09, 0x81, 0x0B};

Buffer operator+(Buffer first, const Buffer& second) {
  first.insert(first.end(), second.begin(), second.end());
  return first;
}

TEST(ModbusTcpProgram, TheGreetingNamesThePortAndACommandThatReadsAModule) {
  SimulatorProcess simulator({"EX9042D-M@01", "--port", "modbus-tcp:0"});
  const std::string port = std::to_string(simulator.tcp_port());
  EXPECT_NE(simulator.output().find("  Modbus TCP 127.0.0.1:" + port), std::string::npos)
      << simulator.output();
  EXPECT_NE(simulator.output().find("mbpoll -m tcp -p " + port + " -a 1 -t 0 -r 1 -c 13 -1 127.0.0.1    #"),
            std::string::npos)
      << simulator.output();
}

TEST(ModbusTcpProgram, TheGreetingWarnsIfTheGatewayReachesNoModule) {
  const std::string warning = "all modules speak ASCII, so each request over Modbus TCP gets exception 0A";
  SimulatorProcess useless({"EX9042D@01", "EX9042D-M@02,protocol=ascii", "--port", "modbus-tcp:0"});
  EXPECT_NE(useless.output().find(warning), std::string::npos) << useless.output();
  SimulatorProcess useful({"EX9042D@01", "EX9042D-M@02", "--port", "modbus-tcp:0"});
  EXPECT_EQ(useful.output().find(warning), std::string::npos) << useful.output();
}

TEST(ModbusTcpProgram, InSteppedTimeAQuietAdvanceEndsAfterTheRepliesToTheArrivedRequests) {
  SimulatorProcess simulator(
      {"EX9042D-M@01", "--port", "modbus-tcp:0", "--speed", "step", "--control", "ctl"});
  ControlClient control(simulator.directory() + "/ctl");
  SocketClient master(simulator.tcp_port());
  master.send(kFirst);
  master.send(kToNobody);
  master.send(kSecond);
  // The module starts up in 100 ms. After the request to unit 9, the gateway waits 211 ms for a reply.
  EXPECT_EQ(control.ok("advance 10s after 36 quiet").rfind("0.3", 0), 0U);
  EXPECT_EQ(master.receive(31), kFirstReply + kNoReply + kSecondReply);
}

TEST(ModbusTcpProgram, TheBytesOfARawClientThatHasLeftDoNotOccupyTheLine) {
  SimulatorProcess simulator({"EX9042D-M@01", "--port", "tcp:0", "--port", "modbus-tcp:0"});
  SocketClient master(simulator.tcp_port(1));
  {
    SocketClient raw(simulator.tcp_port(0));
    raw.send(Buffer(4000, 'x'));  // more than four seconds at 9600 baud
    // The first request waits 500 ms for the line and is not sent. So the program has read the bytes before.
    master.send(kFirst);
    EXPECT_EQ(master.receive(9), (Buffer{0x00, 0x01, 0x00, 0x00, 0x00, 0x03, 0x01, 0x81, 0x0B}));
    raw.abort();
  }
  master.send(kFirst);
  EXPECT_EQ(master.receive(kFirstReply.size()), kFirstReply);
}

TEST(ModbusTcpProgram, TheTimeoutOfTheGatewayCanBeSet) {
  SimulatorProcess simulator(
      {"EX9042D-M@01", "--port", "modbus-tcp:0,timeout=2s", "--speed", "step", "--control", "ctl"});
  ControlClient control(simulator.directory() + "/ctl");
  SocketClient master(simulator.tcp_port());
  master.send(kToNobody);
  EXPECT_EQ(control.ok("advance 10s after 12 quiet").rfind("2.1", 0), 0U);
  EXPECT_EQ(master.receive(9), kNoReply);
}

TEST(ModbusTcpProgram, InSteppedTimeAnAdvanceCountsBytesThatArriveWhileRequestsWait) {
  SimulatorProcess simulator(
      {"EX9042D-M@01", "--port", "modbus-tcp:0", "--speed", "step", "--control", "ctl"});
  ControlClient control(simulator.directory() + "/ctl");
  SocketClient master(simulator.tcp_port());
  constexpr std::size_t kMany = 1000;
  Buffer requests;
  for (std::size_t i = 0; i < kMany; ++i) {
    requests = requests + kFirst;
  }
  master.send(requests);
  control.ok("advance 10ms after 12000");
  master.send(kSecond);
  control.ok("advance 10ms after 12");
  control.ok("advance 100s quiet");
  Buffer replies;
  for (std::size_t i = 0; i < kMany; ++i) {
    replies = replies + kFirstReply;
  }
  EXPECT_EQ(master.receive(11 * (kMany + 1)), replies + kSecondReply);
}

TEST(ModbusTcpProgram, InSteppedTimeTheSameCommandsGiveTheSameLog) {
  std::vector<std::string> runs;
  for (int run = 0; run < 2; ++run) {
    SimulatorProcess simulator(
        {"EX9042D-M@01", "--port", "modbus-tcp:0", "--speed", "step", "--control", "ctl", "--log"});
    ControlClient control(simulator.directory() + "/ctl");
    SocketClient master(simulator.tcp_port());
    for (int i = 0; i < 3; ++i) {
      master.send(kFirst);
      master.send(kToNobody);
      control.ok("advance 1s after 24 quiet");
      control.ok("advance 123ms");
    }
    simulator.end(15);
    const std::string& output = simulator.output();
    runs.push_back(output.substr(output.find("press Ctrl-C")));
  }
  EXPECT_EQ(runs[0], runs[1]);
}

TEST(ModbusTcpProgram, EachLineOfABusFileCanHaveAGateway) {
  Directory directory;
  const std::string file = directory.path() + "/bus.json";
  write_file(file, R"({"lines": [
    {"name": "a", "port": "modbus-tcp:0", "modules": [{"model": "EX9042D-M", "address": "01"}]},
    {"name": "b", "port": "modbus-tcp:localhost:0", "modules": [{"model": "EX9042D-M", "address": "09"}]}]})");
  SimulatorProcess simulator({file});
  SocketClient first(simulator.tcp_port(0));
  SocketClient second(simulator.tcp_port(1));
  first.send(kFirst);
  EXPECT_EQ(first.receive(11), kFirstReply);
  second.send(kToNobody);
  EXPECT_EQ(second.receive(11), (Buffer{0x00, 0x03, 0x00, 0x00, 0x00, 0x05, 0x09, 0x01, 0x02, 0x00, 0x00}));
}

}  // namespace
}  // namespace ex9000::system
