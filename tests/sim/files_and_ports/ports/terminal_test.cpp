// Tests the simulator's pseudo-terminal with DCON commands that a person can type in a terminal program.
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include <string>

#include "tests/support/control_client.hpp"
#include "tests/support/simulator_process.hpp"
#include "tests/support/terminal.hpp"

namespace ex9000::system {
namespace {

TEST(Dcon, TypedCommandsGetRepliesAndAreLogged) {
  SimulatorProcess simulator({"9068d-m@0A,protocol=ascii,name=PUMP", "--log"});
  Terminal terminal(simulator.tty(), 9600);
  terminal.type("$0AM\r");
  EXPECT_EQ(terminal.read_line(), "!0APUMP\r");
  for (const char key : std::string("@0A81\r")) {
    terminal.type(std::string(1, key));
  }
  EXPECT_EQ(terminal.read_line(), ">\r");
  terminal.type("@0A\r");
  EXPECT_EQ(terminal.read_line(), ">8100\r");
  EXPECT_TRUE(simulator.wait_for("> master  @0A81\\r  ; @AA(Data): set all outputs")) << simulator.output();
  EXPECT_TRUE(simulator.wait_for("< 0A EX9068D-M  !0APUMP\\r  ; reply")) << simulator.output();
}

TEST(Dcon, ThePseudoTerminalHasTheModeAndTheGroupOfTheOption) {
  SimulatorProcess simulator(
      {"EX9042D@05", "--port", "pty:ex9000.tty,access=664:" + std::to_string(getegid())});
  struct stat status {};
  ASSERT_EQ(stat(simulator.tty().c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 07777U, 0664U);
  EXPECT_EQ(status.st_gid, getegid());
  EXPECT_EQ(status.st_uid, geteuid());
  Terminal terminal(simulator.tty(), 9600);
  terminal.type("$05M\r");
  EXPECT_EQ(terminal.read_line(), "!059042D\r");
}

TEST(Dcon, TheNextMasterDoesNotReceiveAnUnreadReply) {
  SimulatorProcess simulator({"EX9042D@05,name=FIRST", "--log", "--control", "control"});
  ControlClient control(simulator.directory() + "/control");
  {
    Terminal impatient(simulator.tty(), 9600);
    impatient.type("$05M\r");
    ASSERT_TRUE(simulator.wait_for("!05FIRST")) << simulator.output();
    // The program answers this command after it has written the last byte of the reply to the
    // pseudo-terminal.
    control.ok("list");
  }
  // The program may answer the first of these two commands before it notices that `impatient` has closed the
  // pseudo-terminal. It always notices this before it answers the second command.
  control.ok("list");
  control.ok("list");
  Terminal terminal(simulator.tty(), 9600);
  terminal.type("$052\r");
  EXPECT_EQ(terminal.read_line(), "!05400600\r");
}

// glibc reports EINVAL if nothing of a request takes effect.
TEST(Dcon, EachMasterCanAskForParityOnceAlthoughThePseudoTerminalDropsIt) {
  SimulatorProcess simulator({"EX9042D@05", "--control", "control"});
  ControlClient control(simulator.directory() + "/control");
  for (int visit = 0; visit < 3; ++visit) {
    {
      Terminal terminal(simulator.tty(), 9600);
      EXPECT_TRUE(terminal.set_even_parity(9600)) << visit;
      terminal.type("$05M\r");
      EXPECT_EQ(terminal.read_line(), "!059042D\r");
    }
    control.ok("list");  // see TheNextMasterDoesNotReceiveAnUnreadReply
    control.ok("list");
  }
}

TEST(Dcon, AMasterThatDisconnectsDoesNotDisconnectAnotherMaster) {
  SimulatorProcess simulator({"EX9042D@05"});
  for (int round = 0; round < 5; ++round) {
    Terminal stays(simulator.tty(), 9600);
    { const Terminal goes(simulator.tty(), 9600); }
    stays.type("$05M\r");
    EXPECT_EQ(stays.read_line(), "!059042D\r");
  }
}

TEST(Dcon, TheLineUsesTheBaudRateOfTheMasterAndTheProgramReportsAMismatch) {
  SimulatorProcess simulator({"EX9042D@05,baud=19200", "--baud", "9600"});
  EXPECT_TRUE(simulator.wait_for("the line is at 9600 baud 8N1, EX9042D at 05 listens at 19200 baud 8N1"))
      << simulator.output();
  {
    Terminal terminal(simulator.tty(), 19200);
    terminal.type("$052\r");
    EXPECT_EQ(terminal.read_line(), "!05400700\r");
  }
  Terminal terminal(simulator.tty(), 1200);
  terminal.type("$052\r");
  EXPECT_TRUE(simulator.wait_for("the line is at 1200 baud 8N1, EX9042D at 05 listens at 19200 baud 8N1"))
      << simulator.output();
  // On a busy machine, this check can miss an error. It fails only if there is an error.
  EXPECT_EQ(terminal.read_line(std::chrono::milliseconds(500)), "");
}

// The Rust crates serialport and serial2 set every rate with TCSETS2 and BOTHER, also 9600.
TEST(Dcon, TheLineUsesARateThatWasSetWithBother) {
  SimulatorProcess simulator(
      {"EX9042D@05", "EX9052D@06,baud=19200", "--speed", "step", "--control", "control"});
  ControlClient control(simulator.directory() + "/control");
  Terminal terminal(simulator.tty(), 19200);
  const auto ask = [&](const std::string& request) {
    terminal.type(request);
    control.ok(
        "advance 1s after 5");  // the line is idle at the end, so no receiver is in the middle of a byte
    return terminal.read_line();
  };
  EXPECT_EQ(ask("$06M\r"), "!069052\r");
  terminal.set_any_rate(9600);
  EXPECT_EQ(ask("$05M\r"), "!059042D\r");
  terminal.set_any_rate(19200);
  EXPECT_EQ(ask("$06M\r"), "!069052\r");
}

TEST(Dcon, TheLineUsesARateThatNoModuleSupports) {
  SimulatorProcess simulator({"EX9042D@05"});
  Terminal terminal(simulator.tty(), 9600);
  terminal.set_any_rate(250'000);
  terminal.type("$05M\r");
  EXPECT_TRUE(simulator.wait_for("the line is at 250000 baud 8N1, EX9042D at 05 listens at 9600 baud 8N1"))
      << simulator.output();
}

class ExtremeRate : public testing::TestWithParam<std::uint32_t> {};

TEST_P(ExtremeRate, DoesNotStopTheProgram) {
  SimulatorProcess simulator({"EX9042D@05", "--control", "control"});
  ControlClient control(simulator.directory() + "/control");
  Terminal terminal(simulator.tty(), 9600);
  terminal.set_any_rate(GetParam());
  terminal.type("$");
  EXPECT_TRUE(simulator.wait_for("the line is at " + std::to_string(GetParam()) + " baud 8N1"))
      << simulator.output();
  EXPECT_EQ(control.ok("1 outputs"), "0000");
}

INSTANTIATE_TEST_SUITE_P(Dcon, ExtremeRate, testing::Values(1U, 4'294'967'295U));

}  // namespace
}  // namespace ex9000::system
