// Tests the rate of a pseudo-terminal, as programs set it through the C library and with BOTHER.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>  // NOLINT(modernize-deprecated-headers): posix_openpt
#include <termios.h>

#include <array>
#include <cstdint>

#include "sim/files_and_ports/files/file_descriptor.hpp"
#include "sim/files_and_ports/ports/terminal_rate.hpp"
#include "tests/support/any_rate.hpp"

namespace ex9000::sim {
namespace {

struct Terminal {
  Terminal() {
    std::array<char, 64> name{};
    EXPECT_EQ(unlockpt(master.get()), 0);
    EXPECT_EQ(ptsname_r(master.get(), name.data(), name.size()), 0);
    slave = FileDescriptor(open(name.data(), O_RDWR | O_NOCTTY));
  }
  void set_speed(speed_t speed) const {
    termios settings{};
    ASSERT_EQ(tcgetattr(slave.get(), &settings), 0);
    cfsetspeed(&settings, speed);
    ASSERT_EQ(tcsetattr(slave.get(), TCSANOW, &settings), 0);
  }

  FileDescriptor master{posix_openpt(O_RDWR | O_NOCTTY)};
  FileDescriptor slave;
};

TEST(TerminalRate, IsTheRateOfTheTermiosConstant) {
  const Terminal terminal;
  terminal.set_speed(B19200);
  EXPECT_EQ(terminal_rate(terminal.master.get()), 19200U);
  EXPECT_EQ(terminal_rate(terminal.slave.get()), 19200U);
  terminal.set_speed(B4000000);
  EXPECT_EQ(terminal_rate(terminal.master.get()), 4000000U);
}

TEST(TerminalRate, IsTheRateThatWasSetWithBother) {
  const Terminal terminal;
  for (const std::uint32_t rate : {9600U, 1U, 12345U, 250000U, 4294967295U}) {
    ASSERT_TRUE(system::set_any_rate(terminal.slave.get(), rate)) << rate;
    EXPECT_EQ(terminal_rate(terminal.master.get()), rate);
  }
  terminal.set_speed(B9600);
  EXPECT_EQ(terminal_rate(terminal.master.get()), 9600U);
}

TEST(TerminalRate, IsUnknownAfterAHangUpAndForAFileThatIsNoTerminal) {
  const Terminal terminal;
  terminal.set_speed(B0);
  EXPECT_FALSE(terminal_rate(terminal.master.get()));
  EXPECT_FALSE(terminal_rate(-1));
}

}  // namespace
}  // namespace ex9000::sim
