// Tests the output to a terminal, with a pseudo-terminal in place of a window.
#include "sim/front_ends/terminal_view/terminal_output.hpp"

#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <string>

namespace ex9000::sim {
namespace {

class TerminalOutputTest : public ::testing::Test {
 protected:
  TerminalOutputTest() : window_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    grantpt(window_);
    unlockpt(window_);
    program_ = open(ptsname(window_), O_RDWR | O_NOCTTY | O_CLOEXEC);
    setenv("TERM", "xterm", 1);
  }
  ~TerminalOutputTest() override {
    close(program_);
    close(window_);
  }

  /// Waits for text in the window and returns up to 4096 bytes of it.
  std::string shown() {
    std::array<char, 4096> text{};
    const ssize_t size = read(window_, text.data(), text.size());
    return {text.data(), static_cast<std::size_t>(size > 0 ? size : 0)};
  }

  int window_;
  int program_ = -1;
};

TEST_F(TerminalOutputTest, WritesToTheTerminal) {
  TerminalOutput output(program_);
  ASSERT_TRUE(output.is_open());
  output.write("face");
  EXPECT_TRUE(output.keeps_up());
  EXPECT_EQ(shown(), "face");
}

TEST_F(TerminalOutputTest, ReturnsTheSizeOfTheWindow) {
  const TerminalOutput output(program_);
  EXPECT_EQ(output.screen().rows, 24U);  // the default for a terminal without a size
  EXPECT_EQ(output.screen().columns, 80U);
  const winsize size{50, 132, 0, 0};
  ioctl(window_, TIOCSWINSZ, &size);
  EXPECT_EQ(output.screen().rows, 50U);
  EXPECT_EQ(output.screen().columns, 132U);
}

TEST_F(TerminalOutputTest, StoresOutputThatTheTerminalHasNotAccepted) {
  TerminalOutput output(program_);
  const std::string text(100'000, 'x');
  output.write(text);
  EXPECT_FALSE(output.keeps_up());
  std::string received;
  while (received.size() < text.size()) {
    received += shown();
    output.keeps_up();
  }
  EXPECT_TRUE(output.keeps_up());
  EXPECT_EQ(received, text);
}

TEST_F(TerminalOutputTest, StopsWaitingForTheTerminalIfGivesUpReturnsTrue) {
  TerminalOutput output(program_, [] { return true; });
  output.write(std::string(std::size_t{3} << 20U, 'x'));
  EXPECT_FALSE(output.keeps_up());
}

TEST_F(TerminalOutputTest, IsNotOpenOnADumbTerminalOrAPipe) {
  setenv("TERM", "dumb", 1);
  EXPECT_FALSE(TerminalOutput(program_).is_open());
  setenv("TERM", "xterm", 1);
  std::array<int, 2> pipe_ends{};
  ASSERT_EQ(pipe(pipe_ends.data()), 0);
  EXPECT_FALSE(TerminalOutput(pipe_ends[1]).is_open());
  close(pipe_ends[0]);
  close(pipe_ends[1]);
}

TEST(LocaleNames, RecognizesUtf8InSeveralSpellings) {
  for (const char* name : {"C.UTF-8", "en_US.utf8", "de_DE.UTF8", "en_GB.utf-8", "nl_NL.UTF-8@euro"}) {
    EXPECT_TRUE(names_utf8(name)) << name;
  }
  for (const char* name : {"", "C", "POSIX", "en_US.ISO-8859-1"}) {
    EXPECT_FALSE(names_utf8(name)) << name;
  }
}

}  // namespace
}  // namespace ex9000::sim
