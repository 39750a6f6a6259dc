// Tests --watch in a terminal, in a terminal that is not read, and in a pipe.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <array>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "tests/support/hang.hpp"
#include "tests/support/simulator_process.hpp"
#include "tests/support/terminal.hpp"

namespace ex9000::system {
namespace {

/// Runs the program with `arguments` in a terminal with UTF-8, and returns the text that it prints. The
/// command `script` provides the terminal. `settings` are arguments of stty. Expects the exit status 0.
std::string in_a_terminal(const std::string& settings, const std::string& arguments) {
  const Finished finished = run(
      {"script", "-qec",
       "stty -opost " + settings + "; TERM=xterm LC_ALL=C.UTF-8 exec " + simulator_path() + " " + arguments,
       "/dev/null"});
  EXPECT_EQ(finished.status, 0) << finished.output;
  return finished.output;
}

TEST(WatchedProgram, PaintsModulesOnATerminalAndRepaintsThem) {
  const std::string shown =
      in_a_terminal("rows 7 cols 30", "EX9052D --watch --speed max --for 200ms --input '1 3 square 200ms'");
  const std::string head = "1  EX9052D     9052    01 DCON\n   DI      0  1  2  3  4  5  6\n";
  EXPECT_EQ(shown.substr(shown.find("press Ctrl-C")), "press Ctrl-C to end\n" + head +
                                                          "           ○  ○  ○  ○  ○  ○  ○\n"
                                                          "   counters 0 0 0 0 0 0 0 0\n"
                                                          "   latched high 00, low 00\n"
                                                          "   host watchdog off\n"
                                                          "\x1b[6F\x1b[J" +
                                                          head +
                                                          "           ○  ○  ○  ○  ○  ○  ○\n"
                                                          "   counters 0 0 0 1 0 0 0 0\n"
                                                          "   latched high 08, low 08\n"
                                                          "   host watchdog off\n"
                                                          "\x1b[6F\x1b[J" +
                                                          head +
                                                          "           ○  ○  ○  ●  ○  ○  ○\n"
                                                          "   counters 0 0 0 1 0 0 0 0\n"
                                                          "   latched high 08, low 08\n"
                                                          "   host watchdog off\n");
}

TEST(WatchedProgram, ReportsChangesIfTheOutputIsNotATerminal) {
  const Finished finished = run({simulator_path(), "EX9052D", "--watch", "--speed", "max", "--for", "250ms",
                                 "--input", "1 3 square 200ms"});
  EXPECT_EQ(finished.status, 0) << finished.error;
  EXPECT_EQ(finished.output.find('\x1b'), std::string::npos);
  EXPECT_NE(finished.output.find("    0.100000  - 1 EX9052D: inputs 00\n"), std::string::npos);
  EXPECT_NE(finished.output.find("\n    0.200000  - 1 EX9052D: counters 0 0 0 1 0 0 0 0\n"
                                 "    0.200000  - 1 EX9052D: latched high 08, low 08\n"
                                 "    0.300000  - 1 EX9052D: inputs 08\n"),
            std::string::npos)
      << finished.output;
}

/// Both ends of a pseudo-terminal with 400 rows: the end of the terminal window, and the end for programs.
class Window {
 public:
  Window() : window_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    grantpt(window_);
    unlockpt(window_);
    const winsize size{400, 80, 0, 0};
    ioctl(window_, TIOCSWINSZ, &size);
    device_ = ptsname(window_);
    programs_ = open(device_.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  }
  ~Window() {
    close(window_);
    close(programs_);
  }
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  /// Returns the path of the end for programs.
  [[nodiscard]] const std::string& device() const { return device_; }
  /// Returns whether a program could print in the window without waiting.
  [[nodiscard]] bool has_room() const {
    pollfd ready{programs_, POLLOUT, 0};
    return poll(&ready, 1, 0) == 1;
  }
  /// Waits for printed text and returns up to 64 KiB of it.
  std::string read_some() {
    std::array<char, 65536> buffer{};
    const ssize_t size = read(window_, buffer.data(), buffer.size());
    return {buffer.data(), static_cast<std::size_t>(size > 0 ? size : 0)};
  }

 private:
  int window_;
  int programs_ = -1;
  std::string device_;
};

TEST(WatchedProgram, AModuleRepliesWhileTheTerminalIsNotRead) {
  const Directory directory;
  Window window;
  std::string command = "exec env TERM=xterm " + simulator_path() + " EX9052D@01,baud=115200";
  for (const char* address :
       {"02", "03", "04", "05", "06", "07", "08", "09", "0A", "0B", "0C", "0D", "0E", "0F"}) {
    command += std::string(" EX9052D@") + address;
  }
  command += " --line instant --watch --input '1 0 square 20ms' > " + window.device();
  ChildProcess process({"sh", "-c", command}, directory.path());
  const std::string link = directory / "ex9000.tty";
  ASSERT_TRUE(becomes_true([&link] { return std::filesystem::exists(link); }));
  std::string greeting;
  while (greeting.find("press Ctrl-C to end") == std::string::npos) {
    greeting += window.read_some();
  }
  Terminal master(link, 115200);
  const auto answers = [&master] {
    master.type("$01M\r");
    return master.read_line() == "!019052\r";
  };
  while (window.has_room()) {
    ASSERT_TRUE(answers());
  }
  for (int i = 0; i < 10; ++i) {
    ASSERT_TRUE(answers());
  }
  // When the test reads the window again, the program paints all modules again.
  std::string painted;
  while (!window.has_room()) {
    painted = window.read_some();
  }
  while (painted.find("\x1b[90F\x1b[J1  EX9052D") == std::string::npos ||
         painted.find("\n15 EX9052D") == std::string::npos) {
    painted += window.read_some();
  }
  EXPECT_EQ(process.end(SIGTERM), 0);
}

}  // namespace
}  // namespace ex9000::system
