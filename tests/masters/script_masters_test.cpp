// Tests the simulator with masters in Python and JavaScript (tests/masters/) that use unmodified third-party
// libraries. The masters use the pseudo-terminal, RTU frames over TCP, and Modbus TCP.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdio>
#include <ostream>
#include <string>
#include <vector>

#include "tests/support/in_repository.hpp"
#include "tests/support/left_out.hpp"
#include "tests/support/simulator_process.hpp"

namespace ex9000::system {
namespace {

struct Master {
  const char* library;
  std::vector<std::string> command;

  friend std::ostream& operator<<(std::ostream& out, const Master& master) { return out << master.library; }
};

const std::string kScripts = in_repository("tests/masters");
/// Uses Debian's Python, even if PATH contains another one, because pymodbus is a package of Debian.
const Master kPymodbus{"pymodbus", {"/usr/bin/python3", kScripts + "/pymodbus_master.py"}};
const std::string kModules = "NODE_PATH=" + in_repository("build/node-red/node_modules");
const Master kModbusSerial{"modbus-serial", {"env", kModules, "node", kScripts + "/modbus_serial_master.js"}};
const Master kJsmodbus{"jsmodbus", {"env", kModules, "node", kScripts + "/jsmodbus_master.js"}};

class ScriptMaster : public testing::TestWithParam<Master> {
 protected:
  void SetUp() override {
    if (without(GetParam().library)) {
      GTEST_SKIP() << "left out: " << GetParam().library;
    }
  }
  static void expect_to_pass(std::vector<std::string> arguments) {
    // The limit of `timeout` only detects a master that hangs: a conversation takes less than five minutes.
    // The limit is below that of CTest, so that the test fails with the name of the library.
    std::vector<std::string> command{"timeout", "1200"};
    command.insert(command.end(), GetParam().command.begin(), GetParam().command.end());
    command.insert(command.end(), arguments.begin(), arguments.end());
    const Finished finished = run(command);
    EXPECT_EQ(finished.status, 0) << finished.output << finished.error;
    const std::string summary = std::string(GetParam().library) + " ";
    EXPECT_EQ(finished.output.find(summary), 0U) << finished.output;
    EXPECT_NE(finished.output.find(" checks passed\n"), std::string::npos) << finished.output;
    std::printf("%s: %s", arguments[0].c_str() + 2, finished.output.c_str());
  }
  static std::vector<std::string> modules(const std::string& baud) {
    return {"EX9042D-M@01,baud=" + baud, "EX9052D-M@02,baud=" + baud};
  }
};

TEST_P(ScriptMaster, GetsEveryExpectedReplyOnThePseudoTerminal) {
  SimulatorProcess simulator(modules("9600"));
  expect_to_pass({"--tty", simulator.tty(), "--baud", "9600"});
}

TEST_P(ScriptMaster, GetsEveryExpectedReplyOverTcp) {
  std::vector<std::string> arguments = modules("115200");
  arguments.insert(arguments.end(), {"--port", "tcp:0"});
  SimulatorProcess simulator(arguments);
  expect_to_pass({"--tcp", "127.0.0.1:" + std::to_string(simulator.tcp_port()), "--baud", "115200"});
}

TEST_P(ScriptMaster, GetsEveryExpectedReplyOverModbusTcp) {
  std::vector<std::string> arguments = modules("115200");
  arguments.insert(arguments.end(), {"--port", "modbus-tcp:0"});
  SimulatorProcess simulator(arguments);
  expect_to_pass({"--modbus-tcp", "127.0.0.1:" + std::to_string(simulator.tcp_port()), "--baud", "115200"});
}

TEST_P(ScriptMaster, GetsEveryExpectedReplyOnAnInstantLine) {
  std::vector<std::string> arguments = modules("9600");
  arguments.insert(arguments.end(), {"--timing", "instant"});
  SimulatorProcess simulator(arguments);
  expect_to_pass({"--tty", simulator.tty(), "--baud", "9600"});
}

std::string library_of(const testing::TestParamInfo<Master>& info) {
  std::string name = info.param.library;
  name.erase(std::remove(name.begin(), name.end(), '-'), name.end());
  return name;
}

INSTANTIATE_TEST_SUITE_P(Debian, ScriptMaster, testing::Values(kPymodbus), library_of);
// `tests/long masters` installs these libraries with npm, and runs the tests that are disabled otherwise.
INSTANTIATE_TEST_SUITE_P(DISABLED_Npm, ScriptMaster, testing::Values(kModbusSerial, kJsmodbus), library_of);

}  // namespace
}  // namespace ex9000::system
