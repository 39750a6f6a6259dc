// Tests the program as a process: for example its start, its end, and its messages about wrong arguments.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/ioctl.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <iomanip>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

#include "firmware/model/model.hpp"
#include "tests/support/hang.hpp"
#include "tests/support/in_repository.hpp"
#include "tests/support/simulator_process.hpp"
#include "tests/support/socket_client.hpp"

namespace ex9000::system {
namespace {

namespace fs = std::filesystem;

Finished simulator(std::vector<std::string> arguments, const std::string& directory) {
  arguments.insert(arguments.begin(), simulator_path());
  return run(arguments, directory);
}

TEST(Program, EndsCleanlyAfterTheReaderOfItsLogClosesThePipe) {
  Directory directory;
  // A master that continues to send makes the log grow after `head` has ended.
  const Finished finished =
      run({"sh", "-c",
           "(" + simulator_path() +
               " EX9042D --log; echo ended $? >&2) | head -n 1 & "
               "until [ -L ex9000.tty ]; do :; done; "
               "while [ -L ex9000.tty ]; do printf '$012\\r' > ex9000.tty; done 2>/dev/null; wait"},
          directory.path());
  EXPECT_NE(finished.error.find("ended 0"), std::string::npos) << finished.error;
  EXPECT_FALSE(fs::is_symlink(directory.path() + "/ex9000.tty"));
}

TEST(Program, ASignalThatIsIgnoredAtStartStaysIgnored) {
  const Directory directory;
  ChildProcess process({"sh", "-c", "trap '' HUP; exec " + simulator_path() + " EX9042D"}, directory.path());
  ASSERT_TRUE(process.wait_for("press Ctrl-C to end"));
  std::ifstream status("/proc/" + std::to_string(process.pid()) + "/status");
  std::string line;
  while (std::getline(status, line) && line.rfind("SigIgn:", 0) != 0) {
  }
  ASSERT_FALSE(line.empty());
  const unsigned long ignored = std::stoul(line.substr(line.find('\t') + 1), nullptr, 16);
  EXPECT_EQ(ignored >> (SIGHUP - 1) & 1U, 1U);  // the program has not installed a handler for SIGHUP
  EXPECT_EQ(ignored >> (SIGTERM - 1) & 1U, 0U);
  EXPECT_EQ(process.end(SIGTERM), 0);
}

TEST(Program, StandardStreamsMayBeClosed) {
  const Directory directory;
  const Finished finished =
      run({"sh", "-c",
           simulator_path() + " EX9042D@05 <&- >&- 2>&- & until [ -L ex9000.tty ]; do :; done; "
                              "kill -TERM $!; wait $!"},
          directory.path());
  EXPECT_EQ(finished.status, 0);
  EXPECT_TRUE(fs::is_empty(directory.path()));
}

TEST(Program, AFullDiskForStandardOutputIsReported) {
  const Directory directory;
  for (const char* arguments : {" EX9042D", " --help", " describe"}) {
    const Finished finished =
        run({"sh", "-c", simulator_path() + arguments + " > /dev/full"}, directory.path());
    EXPECT_EQ(finished.status, 1) << arguments;
    EXPECT_NE(finished.error.find("standard output: "), std::string::npos) << finished.error;
    EXPECT_EQ(std::count(finished.error.begin(), finished.error.end(), '\n'), 1) << finished.error;
    EXPECT_TRUE(fs::is_empty(directory.path()));
  }
}

/// Waits until at least 7/8 of a pipe is in use. The kernel may begin a new page of the pipe before the
/// previous page is full, so the number of bytes in the pipe may never reach its capacity. Returns false if
/// the wait takes longer than 60 s, for example because the program hangs, or if FIONREAD fails.
bool wait_until_full(int pipe) {
  const int capacity = fcntl(pipe, F_GETPIPE_SZ);
  const auto began = std::chrono::steady_clock::now();
  for (int waiting = 0; waiting < capacity - capacity / 8;) {
    if (ioctl(pipe, FIONREAD, &waiting) != 0 || std::chrono::steady_clock::now() - began > kHang) {
      return false;
    }
    std::this_thread::yield();
  }
  return true;
}

/// Sends `signal` to the process `pid`, which is a child of the test. Returns whether the process ends within
/// 60 s. Does not read the output of the process, in contrast to SimulatorProcess::end. Call
/// SimulatorProcess::end after this function.
bool ends_unread(int pid, int signal) {
  const auto process = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
  pollfd ended{process, POLLIN, 0};
  kill(pid, signal);
  const bool has_ended = poll(&ended, 1, kHangMilliseconds) == 1;
  close(process);
  return has_ended;
}

TEST(Program, ASignalEndsTheProgramIfThePipeOfItsLogIsFull) {
  for (const int signal : {SIGINT, SIGTERM}) {
    SimulatorProcess simulator({"EX9042D@01", "--port", "tcp:0", "--timing", "instant", "--log"});
    SocketClient master(simulator.tcp_port());
    std::string requests;
    for (int i = 0; i < 4000; ++i) {
      requests += "$01M\r";
    }
    master.send(requests);
    const std::string out = "/proc/" + std::to_string(simulator.pid()) + "/fd/1";
    const int pipe = open(out.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    ASSERT_GE(pipe, 0);
    ASSERT_TRUE(wait_until_full(pipe));
    EXPECT_TRUE(ends_unread(simulator.pid(), signal));
    EXPECT_EQ(simulator.end(signal), 0);
    close(pipe);
  }
}

TEST(Program, ASignalEndsTheProgramIfThePipeOfItsCaptureIsFull) {
  {
    const Directory directory;
    ASSERT_EQ(mkfifo((directory / "fifo").c_str(), 0600), 0);
    const int pipe = open((directory / "fifo").c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_GE(pipe, 0);
    write_file(directory / "bus.json", R"({"lines": [
      {"port": "tcp:0", "timing": "instant", "modules": [{"model": "EX9042D", "address": "01"}]},
      {"port": "pty:)" + (directory / "link") +
                                           R"(", "modules": [{"model": "EX9042D", "address": "01"}]}]})");
    SimulatorProcess simulator({directory / "bus.json", "--capture", directory / "fifo"});
    SocketClient master(simulator.tcp_port());
    std::string requests;
    for (int i = 0; i < 4000; ++i) {
      requests += "$01M\r";
    }
    master.send(requests);
    ASSERT_TRUE(wait_until_full(pipe));
    EXPECT_TRUE(ends_unread(simulator.pid(), SIGTERM));
    EXPECT_EQ(simulator.end(SIGTERM), 0);
    close(pipe);
  }
}

TEST(Program, ASignalEndsTheProgramIfItsGreetingIsNotRead) {
  for (const std::string log : {"off", "json"}) {  // with json, the greeting is on standard error
    const Directory directory;
    std::ofstream bus(directory / "bus.json");
    bus << R"({"lines": [{"port": "pty:link", "modules": [)";
    for (int address = 1; address <= 200; ++address) {
      bus << (address > 1 ? "," : "") << R"({"model": "EX9042D", "address": ")" << std::hex << std::setw(2)
          << std::setfill('0') << address << "\"}";
    }
    bus << "]}]}";
    bus.close();
    ASSERT_EQ(mkfifo((directory / "fifo").c_str(), 0600), 0);
    const int pipe = open((directory / "fifo").c_str(), O_RDWR | O_CLOEXEC);
    ASSERT_GE(pipe, 0);
    ASSERT_GT(fcntl(pipe, F_SETPIPE_SZ, 4096), 0);
    ChildProcess process(
        {"sh", "-c",
         "exec " + simulator_path() + " bus.json --log " + log + (log == "json" ? " 2" : " ") + "> fifo"},
        directory.path());
    ASSERT_TRUE(wait_until_full(pipe));
    EXPECT_EQ(process.end(SIGTERM), 0) << log;
    EXPECT_FALSE(fs::is_symlink(directory / "link"));
    close(pipe);
  }
}

TEST(Program, AFileSizeLimitForStandardOutputIsReported) {
  const Directory directory;
  const Finished finished =
      run({"sh", "-c", "ulimit -f 0; exec " + simulator_path() + " --help > help"}, directory.path());
  EXPECT_EQ(finished.status, 1);
  EXPECT_EQ(finished.error, "ex9000-sim: standard output: File too large\n");
}

TEST(Program, ALinkThatTheSimulatorOfAnotherUserUsesIsNotTakenOver) {
  if (geteuid() != 0) {
    GTEST_SKIP() << "only root can start a simulator as another user";
  }
  SimulatorProcess process({"EX9042D"});
  fs::permissions(process.directory(), fs::perms::all);
  const Finished other = run({"setpriv", "--reuid=65534", "--clear-groups", simulator_path(), "EX9052D",
                              "--port", "pty:" + process.tty()},
                             process.directory());
  EXPECT_EQ(other.status, 1) << other.error;
  EXPECT_NE(other.error.find("another simulator uses this path"), std::string::npos) << other.error;
}

TEST(Program, WrongArgumentsGiveAOneLineErrorAndCreateNoFiles) {
  struct Case {
    std::vector<std::string> arguments;
    std::string names;
    std::string mend;
    int status = 2;  ///< 1: the next start may succeed without a change of the configuration
  };
  const std::vector<Case> cases{
      {{}, "no module", "EX9042D-M"},
      {{"EX1234"}, "EX1234", "--models"},
      {{"EX9042D,colour=red"}, "colour=: unknown key", "expected one of address, protocol"},
      {{"EX9042D", "--bogus"}, "--bogus", "--help"},
      {{"describe", "EX1"}, "'EX1'", "--models"},
      {{"EX9042D", "--port", "pty:/no/such/place/tty"}, "--port: /no/such/place/tty", "path"},
      {{"EX9042D", "--port", "tcp:192.0.2.1:5020"}, "--port: 192.0.2.1:5020", "name", 1},
      {{"EX9042D-M", "--port", "modbus-tcp:192.0.2.1:502"}, "--port: 192.0.2.1:502", "name", 1},
      {{"EX9042D", "--port", "serial:/no/such/port"}, "--port: /no/such/port", "name", 1},
      {{"EX9042D", "--control", "/no/such/place/ctl"}, "--control: /no/such/place/ctl", "path"},
      {{"EX9042D", "--capture", "/no/such/place/pcapng"}, "--capture: /no/such/place/pcapng", "path"},
      {{"EX9042D", "--capture", "."}, "--capture: .", "path"},
      {{"EX9042D", "--capture", "a", "--control", "/no/such/place/ctl"}, "--control", "path"},
      {{"EX9042D,eeprom=/no/such/place/bin", "--capture", "a"}, "eeprom=: /no/such/place/bin", "path"},
      {{"play", "none.txt", "EX9042D", "--capture", "a"}, "none.txt: cannot be read", "name a transcript"},
      {{"EX9042D", "--port", "pty:a", "--capture", "a"}, "--capture: a: is the port a", "another path"},
      {{"EX9042D", "--control", "a", "--capture", "./a"},
       "--capture: ./a: is the control socket a",
       "another path"},
      {{"EX9042D,eeprom=a", "--capture", "a"}, "--capture: a: is a module's EEPROM file a", "another path"},
  };
  for (const Case& wrong : cases) {
    Directory directory;
    const Finished finished = simulator(wrong.arguments, directory.path());
    EXPECT_EQ(finished.status, wrong.status) << finished.error;
    EXPECT_EQ(finished.output, "");
    EXPECT_EQ(std::count(finished.error.begin(), finished.error.end(), '\n'), 1) << finished.error;
    EXPECT_NE(finished.error.find(wrong.names), std::string::npos) << finished.error;
    EXPECT_NE(finished.error.find(wrong.mend), std::string::npos) << finished.error;
    EXPECT_TRUE(fs::is_empty(directory.path())) << finished.error;
  }
}

TEST(Program, WaitingForAnEventInTheFarFutureUsesLittleProcessorTime) {
  // At the lowest speed, a year of line time takes 1000 years on the wall clock. A signed 64-bit count of
  // nanoseconds covers only 292 years. In the first run, the fault "gone" switches off the module's power, so
  // the module causes no earlier event.
  for (const std::vector<std::string>& far :
       {std::vector<std::string>{"--fault", "gone", "--fault", "gone at 8760h"}, {"--for", "8760h"}}) {
    std::vector<std::string> arguments{"EX9042D", "--speed", "0.001"};
    arguments.insert(arguments.end(), far.begin(), far.end());
    SimulatorProcess process(arguments);
    const auto ticks = [&process] {
      std::ifstream status("/proc/" + std::to_string(process.pid()) + "/stat");
      std::string word;
      unsigned long used = 0;
      for (int field = 1; status >> word; ++field) {
        used += field == 14 || field == 15 ? std::stoul(word) : 0;
      }
      return used;
    };
    const unsigned long before = ticks();
    // The period in which the processor time is measured. A program that waits in a busy loop would use most
    // of this time.
    std::this_thread::sleep_for(std::chrono::milliseconds(500));
    EXPECT_LT(ticks() - before, 5U) << "processor time, in units of 10 ms, within 500 ms";
    EXPECT_EQ(process.end(SIGTERM), 0);
  }
}

/// Returns the seconds from the start to the end of a run of the program. If the program has not ended after
/// ten minutes, the command `timeout` ends it and returns a status other than 0.
double seconds_of_a_run(const std::string& speed, const std::string& lasts) {
  const Directory directory;
  const auto began = std::chrono::steady_clock::now();
  const Finished finished = run(
      {"timeout", "600", simulator_path(), "EX9042D", "--speed", speed, "--for", lasts}, directory.path());
  EXPECT_EQ(finished.status, 0) << "--speed " << speed << " --for " << lasts << " " << finished.error;
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count();
}

TEST(Program, RunDurationIsMeasuredInLineTime) {
  // Load on the machine can extend a run, but nothing can shorten it.
  EXPECT_GE(seconds_of_a_run("0.01", "5ms"), 0.5);
  EXPECT_GE(seconds_of_a_run("1", "400ms"), 0.4);
  // With --speed 1000, 30 minutes of line time take 1.8 s on the wall clock.
  EXPECT_GE(seconds_of_a_run("1000", "30min"), 1.8);
}

TEST(Program, AFileAtThePathOfTheLinkIsNotReplaced) {
  Directory directory;
  std::ofstream(directory.path() + "/ex9000.tty") << "precious";
  const Finished finished = simulator({"EX9042D"}, directory.path());
  EXPECT_EQ(finished.status, 2);
  EXPECT_NE(finished.error.find("exists and is not a link to a pseudo-terminal"), std::string::npos)
      << finished.error;
  EXPECT_TRUE(fs::is_regular_file(directory.path() + "/ex9000.tty"));
}

TEST(Program, ALinkInUseIsRefusedAndAStaleOneIsTakenOver) {
  SimulatorProcess process({"EX9042D-M"});
  const Finished second = simulator({"EX9042D"}, process.directory());
  EXPECT_EQ(second.status, 1);
  EXPECT_NE(second.error.find("another simulator"), std::string::npos) << second.error;
  EXPECT_TRUE(fs::is_symlink(process.tty()));
  process.end(SIGKILL);
  ASSERT_TRUE(fs::is_symlink(process.tty()));
  SimulatorProcess heir({"EX9042D", "--port", "pty:" + process.tty()});
  EXPECT_NE(heir.output().find("press Ctrl-C to end"), std::string::npos);
  EXPECT_EQ(heir.end(SIGTERM), 0);
  EXPECT_FALSE(fs::is_symlink(process.tty()));
}

TEST(Program, AStaleLinkToTheTerminalOfAnotherSimulatorIsTakenOver) {
  SimulatorProcess other({"EX9042D-M"});
  const Directory directory;
  const std::string link = directory.path() + "/left.tty";
  fs::create_symlink(fs::read_symlink(other.tty()), link);
  SimulatorProcess heir({"EX9042D", "--port", "pty:" + link});
  EXPECT_NE(heir.output().find("press Ctrl-C to end"), std::string::npos);
  EXPECT_NE(fs::read_symlink(link), fs::read_symlink(other.tty()));
}

TEST(Program, RunsFromItsInstallPrefix) {
  const Directory directory;
  const Finished installed =
      run({"cmake", "--install", in_repository(EX9000_BUILD), "--prefix", directory.path()});
  EXPECT_EQ(installed.status, 0) << installed.error;
  EXPECT_EQ(run({directory.path() + "/bin/ex9000-sim", "--version"}, "/").output, "ex9000-sim D01.00\n");
}

TEST(Program, PrintsMbpollLinesThatWorkWhenPasted) {
  SimulatorProcess process({"EX9042D-M@01", "EX9052D-M@1A"});
  int pasted = 0;
  std::string line;
  for (std::istringstream lines(process.output()); std::getline(lines, line);) {
    if (line.find("mbpoll ") == std::string::npos) {
      continue;
    }
    const Finished finished = run({"sh", "-c", line}, process.directory());
    EXPECT_EQ(finished.status, 0) << line << "\n" << finished.output << finished.error;
    ++pasted;
  }
  EXPECT_EQ(pasted, 4);
}

}  // namespace
}  // namespace ex9000::system
