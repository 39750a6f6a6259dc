// Tests the program in stepped time through its ports and its control socket.
#include <gtest/gtest.h>

#include <csignal>
#include <string>

#include "tests/support/control_client.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/simulator_process.hpp"
#include "tests/support/socket_client.hpp"
#include "tests/support/terminal.hpp"

namespace ex9000::system {
namespace {

/// A simulator in stepped time, with its control socket.
class Stepped {
 public:
  explicit Stepped(std::vector<std::string> arguments)
      : simulator(with_time_that_stands_still(std::move(arguments))),
        control(simulator.directory() + "/ctl") {}

  SimulatorProcess simulator;
  ControlClient control;

 private:
  static std::vector<std::string> with_time_that_stands_still(std::vector<std::string> arguments) {
    for (const char* word : {"--speed", "step", "--control", "ctl"}) {
      arguments.emplace_back(word);
    }
    return arguments;
  }
};

TEST(SteppedProgram, TheHostWatchdogExpiresWhenOneCommandAdvancesADay) {
  Stepped stepped({"EX9042D"});
  Terminal master(stepped.simulator.tty(), 9600);
  master.type("~0131FF\r");  // enables the host watchdog, timeout 25.5 s
  EXPECT_EQ(stepped.control.ok("advance 1s after 8 quiet").rfind("0.1", 0), 0U);
  EXPECT_EQ(master.read_line(), "!01\r");
  stepped.control.ok("advance 24h");
  master.type("~010\r");
  stepped.control.ok("advance 1s after 5 quiet");
  EXPECT_EQ(master.read_line(), "!0184\r");
}

TEST(SteppedProgram, AnAdvanceWaitsForAMasterThatWritesLater) {
  Stepped stepped({"EX9042D", "--port", "tcp:0"});
  SocketClient master(stepped.simulator.tcp_port());
  stepped.control.send("advance 1s after 5 quiet\n");
  master.send("$01");
  master.send("M\r");
  EXPECT_EQ(stepped.control.line().rfind("ok 0.1", 0), 0U);
  EXPECT_EQ(master.receive_text(9), "!019042D\r");
}

TEST(SteppedProgram, TheSameCommandsAndTheSameSeedProduceTheSameBytesAtTheSameTimes) {
  const auto run_once = [](const char* seed) {
    Stepped stepped({"EX9042D@01", "EX9052D-M@02", "--capture", "line.pcapng", "--log", "--seed", seed,
                     "--fault", "bit-errors 1e-3", "--for", "1h"});
    Terminal master(stepped.simulator.tty(), 9600);
    std::string text;
    for (int i = 0; i < 20; ++i) {
      master.type("@01\r");
      text += stepped.control.ok("advance 1s after 4 quiet") + " " + stepped.control.ok("sent") + "\n";
    }
    EXPECT_EQ(stepped.control.ok("advance 2h"), "3600.1");  // --for ends the program at this time
    EXPECT_EQ(stepped.simulator.wait(), 0);
    const std::string& output = stepped.simulator.output();
    return text + output.substr(output.find("press Ctrl-C to end")) +
           bytes_of_file(stepped.simulator.directory() + "/line.pcapng");
  };
  const std::string first = run_once("7");
  EXPECT_EQ(first, run_once("7"));
  EXPECT_NE(first, run_once("8"));
  EXPECT_NE(first.find("> master  @01"), std::string::npos) << first;
}

TEST(SteppedProgram, ASignalEndsTheProgramDuringALongAdvance) {
  Stepped stepped({"EX9042D", "--log"});
  stepped.control.ok("fault foreign-traffic 2430314D0D at 1min");
  stepped.control.send("advance 8760h\n");
  ASSERT_TRUE(stepped.simulator.wait_for("unknown sender")) << stepped.simulator.output();
  EXPECT_EQ(stepped.simulator.end(SIGTERM), 0);
}

TEST(SteppedProgram, TheControlSocketSetsTheBaudRateOfALineWithATcpPort) {
  Stepped stepped({"EX9042D@01,baud=19200", "--baud", "9600", "--port", "tcp:0"});
  SocketClient master(stepped.simulator.tcp_port());
  master.send("$01M\r");
  stepped.control.ok("advance 1s after 5");
  EXPECT_EQ(stepped.control.ok("sent"), "0");
  EXPECT_EQ(stepped.control.ask("baud 19200"), "ok");
  master.send("\r$01M\r");
  stepped.control.ok("advance 1s after 6");
  EXPECT_EQ(master.receive_text(9), "!019042D\r");
}

}  // namespace
}  // namespace ex9000::system
