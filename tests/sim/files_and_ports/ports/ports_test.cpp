// Tests the TCP ports and the serial ports of the program.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/file.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>

#include "firmware/line/crc16.hpp"
#include "tests/support/hang.hpp"
#include "tests/support/simulator_process.hpp"
#include "tests/support/socket_client.hpp"
#include "tests/support/terminal.hpp"

namespace ex9000::system {
namespace {

namespace fs = std::filesystem;

/// The exit status if the next start may succeed without a change of the configuration.
constexpr int kUnavailable = 1;

void expect_refused(const Finished& finished, const std::string& names, const std::string& mend,
                    int status = 2) {
  EXPECT_EQ(finished.status, status) << finished.error;
  EXPECT_EQ(finished.output, "");
  EXPECT_EQ(std::count(finished.error.begin(), finished.error.end(), '\n'), 1) << finished.error;
  EXPECT_NE(finished.error.find(names), std::string::npos) << finished.error;
  EXPECT_NE(finished.error.find(mend), std::string::npos) << finished.error;
}

class Tcp : public testing::TestWithParam<const char*> {};

TEST_P(Tcp, ATcpPortAndAPseudoTerminalReachTheSameLine) {
  SimulatorProcess simulator(
      {"EX9042D@05", "--port", "pty:ex9000.tty", "--port", "tcp::0", "--timing", GetParam()});
  SocketClient client(simulator.tcp_port());
  client.send("$05M\r");
  EXPECT_EQ(client.receive_text(9), "!059042D\r");
  Terminal terminal(simulator.tty(), 9600);
  terminal.type("@050001\r");
  EXPECT_EQ(terminal.read_line(), ">\r");
  EXPECT_EQ(client.receive_text(2), ">\r");
  client.send("@05\r");
  EXPECT_EQ(client.receive_text(6), ">0001\r");
  EXPECT_EQ(terminal.read_line(), ">0001\r");
}

TEST_P(Tcp, TwoClientsShareTheLine) {
  SimulatorProcess simulator({"EX9042D@05", "--port", "tcp:0", "--timing", GetParam()});
  SocketClient first(simulator.tcp_port());
  auto second = std::make_unique<SocketClient>(simulator.tcp_port());
  second->send("$05M\r");  // the program accepts the first client before this one
  EXPECT_EQ(second->receive_text(9), "!059042D\r");
  EXPECT_EQ(first.receive_text(9), "!059042D\r");
  first.send("$052\r");
  EXPECT_EQ(second->receive_text(10), "!05400600\r");
  EXPECT_EQ(first.receive_text(10), "!05400600\r");
  second.reset();
  first.send("@05\r");
  EXPECT_EQ(first.receive_text(6), ">0000\r");
}

TEST_P(Tcp, AHalfClosedClientGetsItsReplyAndIsThenDisconnected) {
  SimulatorProcess simulator({"EX9042D@05", "--port", "tcp:0", "--timing", GetParam()});
  SocketClient client(simulator.tcp_port());
  client.send("$05M\r");
  client.close_writing();
  EXPECT_EQ(client.receive_text(9), "!059042D\r");
  EXPECT_FALSE(fs::is_symlink(simulator.tty()));
  EXPECT_TRUE(client.closed());
}

/// Sends the request, and reads until `reply` arrives. Sends the request again if nothing has arrived for a
/// second. Sends at most 60 requests in total. Returns the bytes that have arrived; bytes after the reply may
/// be missing.
std::string heard_by_asking_again(SocketClient& client, const std::string& request,
                                  const std::string& reply) {
  // A busy machine can only cause more requests. The limit of 60 only detects a program that hangs.
  constexpr std::chrono::seconds kPatience{1};
  std::string heard;
  for (int tries = 0; tries < 60 && heard.find(reply) == std::string::npos; ++tries) {
    client.send(request);
    std::vector<std::uint8_t> more = client.receive_some(kPatience);
    while (!more.empty() && heard.find(reply) == std::string::npos) {
      heard.append(more.begin(), more.end());
      more = client.receive_some(kPatience);
    }
  }
  return heard;
}

TEST_P(Tcp, AClientThatResetsItsConnectionDoesNotAffectOthers) {
  SimulatorProcess simulator({"EX9042D@05", "--port", "tcp:0", "--timing", GetParam()});
  SocketClient other(simulator.tcp_port());
  for (int visit = 0; visit < 20; ++visit) {
    SocketClient client(simulator.tcp_port());
    client.send("$05M\r");
    client.abort();
  }
  // The replies to the aborted clients may collide with the request of `other`. `other` therefore repeats its
  // request when nothing has arrived for a second.
  EXPECT_NE(heard_by_asking_again(other, "\r$052\r", "!05400600\r").find("!05400600\r"), std::string::npos);
  EXPECT_EQ(simulator.end(SIGTERM), 0);
}

TEST_P(Tcp, AFloodOfInvalidBytesDoesNotBlockTheLine) {
  SimulatorProcess simulator({"EX9042D@05,baud=115200", "--port", "tcp:0", "--timing", GetParam()});
  {
    SocketClient flooder(simulator.tcp_port());
    flooder.send(std::vector<std::uint8_t>(20'000, 'x'));
  }
  SocketClient client(simulator.tcp_port());
  // The reply may collide with the bytes of `flooder`, so the client repeats the request.
  EXPECT_NE(heard_by_asking_again(client, "\r$05M\r", "!059042D\r").find("!059042D\r"), std::string::npos);
}

INSTANTIATE_TEST_SUITE_P(Lines, Tcp, testing::Values("paced", "instant"));

TEST(TcpPort, ServesManyClientsOneAfterTheOther) {
  SimulatorProcess simulator({"EX9042D@05", "--port", "tcp:0", "--timing", "instant"});
  for (int visit = 0; visit < 300; ++visit) {
    SocketClient client(simulator.tcp_port());
    client.send("$05M\r");
    ASSERT_EQ(client.receive_text(9), "!059042D\r") << visit;
  }
}

TEST(TcpPort, Serves64ClientsAtTheSameTimeAndReusesAFreePlace) {
  SimulatorProcess simulator({"EX9042D@05", "--port", "tcp:0", "--timing", "instant"});
  std::vector<std::unique_ptr<SocketClient>> clients;
  for (int i = 0; i < 64; ++i) {
    clients.push_back(std::make_unique<SocketClient>(simulator.tcp_port()));
  }
  SocketClient too_many(simulator.tcp_port());
  EXPECT_TRUE(too_many.closed());
  clients.back()->send("$05M\r");
  for (const auto& client : clients) {
    EXPECT_EQ(client->receive_text(9), "!059042D\r");
  }
  clients.pop_back();
  SocketClient next(simulator.tcp_port());
  next.send("$052\r");
  EXPECT_EQ(next.receive_text(10), "!05400600\r");
}

TEST(TcpPort, ListensOnAnIpv6Address) {
  if (!fs::exists("/proc/net/if_inet6")) {
    GTEST_SKIP() << "this machine has no IPv6";
  }
  const std::string host = "[::1]";
  SimulatorProcess simulator({"EX9042D", "--port", "tcp:" + host + ":0"});
  EXPECT_NE(simulator.output().find("  TCP " + host + ":"), std::string::npos) << simulator.output();
}

// If too many bytes already wait for the line, the program stops reading from the client until the line has
// room. During this time, the program must not poll the client.
TEST(TcpPort, AWaitingClientUsesLittleProcessorTime) {
  SimulatorProcess simulator({"EX9042D@05,baud=1200", "--port", "tcp:0"});
  SocketClient flooder(simulator.tcp_port());
  flooder.send(std::vector<std::uint8_t>(20'000, 'x'));  // takes almost three minutes at 1200 baud
  const auto ticks = [&simulator] {
    std::ifstream stat("/proc/" + std::to_string(simulator.pid()) + "/stat");
    std::string word;
    for (int i = 0; i < 13; ++i) {
      stat >> word;
    }
    long user = 0;
    long system = 0;
    stat >> user >> system;
    return user + system;
  };
  // Gives the program time to read as much as it accepts. On a busy machine the measurement can include a
  // part of this work, which takes far less processor time than polling.
  EXPECT_TRUE(flooder.hears_nothing_for(std::chrono::milliseconds(200)));
  // Compares processor time with the wall clock, because a program that polls uses all the processor time
  // that it gets.
  const auto began = std::chrono::steady_clock::now();
  const long before = ticks();
  EXPECT_TRUE(flooder.hears_nothing_for(std::chrono::milliseconds(1000)));
  const long used = ticks() - before;
  const std::chrono::duration<double> passed = std::chrono::steady_clock::now() - began;
  EXPECT_LT(static_cast<double>(used), passed.count() * static_cast<double>(sysconf(_SC_CLK_TCK)) / 4);
}

TEST(TcpPort, APortInUseIsRefusedAndCanBeReusedAfterItsProcessIsKilled) {
  SimulatorProcess first({"EX9042D@05", "--port", "tcp:0"});
  const std::string address = "127.0.0.1:" + std::to_string(first.tcp_port());
  expect_refused(run({simulator_path(), "EX9042D", "--port", "tcp:" + address}, first.directory()),
                 "--port: " + address, "the port is in use", kUnavailable);
  SocketClient client(first.tcp_port());
  client.send("$05M\r");
  EXPECT_EQ(client.receive_text(9), "!059042D\r");
  first.end(SIGKILL);
  SimulatorProcess second({"EX9042D@05", "--port", "tcp:" + address});
  SocketClient heir(second.tcp_port());
  heir.send("$05M\r");
  EXPECT_EQ(heir.receive_text(9), "!059042D\r");
}

/// A pseudo-terminal that replaces a serial cable. This object holds the far end. The near end is the device
/// that the program opens.
class Cable {
 public:
  Cable() : far_(posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC)) {
    std::array<char, 64> name{};
    grantpt(far_);
    unlockpt(far_);
    ptsname_r(far_, name.data(), name.size());
    device_ = name.data();
  }
  ~Cable() { pull(); }
  Cable(const Cable&) = delete;
  Cable& operator=(const Cable&) = delete;

  [[nodiscard]] const std::string& device() const { return device_; }
  void write(const std::string& text) const {
    ASSERT_EQ(::write(far_, text.data(), text.size()), static_cast<ssize_t>(text.size()));
  }
  /// Returns `count` bytes, or fewer if no byte arrives for a minute or if reading fails.
  [[nodiscard]] std::string read(std::size_t count) const {
    std::string bytes;
    while (bytes.size() < count && read_one(bytes)) {
    }
    return bytes;
  }
  /// Returns the bytes up to and including CR, or fewer if no byte arrives for a minute or if reading fails.
  [[nodiscard]] std::string read_line() const {
    std::string line;
    while ((line.empty() || line.back() != '\r') && read_one(line)) {
    }
    return line;
  }
  [[nodiscard]] termios settings() const {
    termios settings{};
    tcgetattr(far_, &settings);
    return settings;
  }
  /// Changes the settings of the port, as another program could do. Most of the new settings are unsuitable
  /// for a line of modules. The number of data bits stays 8, because a pseudo-terminal has no other number.
  void leave_set_for_something_else() const {
    termios settings{};
    tcgetattr(far_, &settings);
    settings.c_iflag = IGNBRK | BRKINT | PARMRK | INPCK | ISTRIP | INLCR | ICRNL | IXON | IXOFF | IXANY;
    settings.c_oflag = OPOST | ONLCR | OCRNL;
    settings.c_lflag = ICANON | ECHO | ECHOE | ECHONL | ISIG | IEXTEN;
    settings.c_cflag = CS8 | CSTOPB | CRTSCTS | HUPCL;
    cfsetspeed(&settings, B300);
    ASSERT_EQ(tcsetattr(far_, TCSANOW, &settings), 0);
    const termios left = this->settings();
    ASSERT_NE(left.c_cflag & static_cast<tcflag_t>(CRTSCTS), 0U);
    ASSERT_NE(left.c_cflag & static_cast<tcflag_t>(CSTOPB), 0U);
    ASSERT_EQ(left.c_cflag & static_cast<tcflag_t>(CLOCAL), 0U);
  }
  void pull() {
    if (far_ >= 0) {
      close(far_);
      far_ = -1;
    }
  }

 private:
  bool read_one(std::string& bytes) const {
    pollfd ready{far_, POLLIN, 0};
    char byte = 0;
    if (poll(&ready, 1, kHangMilliseconds) != 1 || ::read(far_, &byte, 1) != 1) {
      return false;
    }
    bytes += byte;
    return true;
  }

  int far_;
  std::string device_;
};

TEST(SerialPort, ConnectsTheModulesToItsLine) {
  const Cable cable;
  SimulatorProcess simulator({"EX9042D@05", "EX9052D@06", "--port", "serial:" + cable.device()});
  EXPECT_FALSE(fs::is_symlink(simulator.tty()));
  for (int round = 0; round < 3; ++round) {
    cable.write("$05M\r");
    EXPECT_EQ(cable.read_line(), "!059042D\r");
    cable.write("$06M\r");
    EXPECT_EQ(cable.read_line(), "!069052\r");
  }
  EXPECT_EQ(simulator.end(SIGTERM), 0);
}

// Adapters have control signals that modules do not have. With some adapters, CTS and carrier detect are
// never active, so the program must ignore these signals.
TEST(SerialPort, IsSetToTheBaudRateOfTheLineAndToRawModeWithoutFlowControl) {
  const Cable cable;
  cable.leave_set_for_something_else();
  SimulatorProcess simulator(
      {"EX9042D@05", "EX9052D@06,baud=19200", "--port", "serial:" + cable.device(), "--baud", "19200"});
  const termios settings = cable.settings();
  EXPECT_EQ(cfgetospeed(&settings), static_cast<speed_t>(B19200));
  EXPECT_EQ(cfgetispeed(&settings), static_cast<speed_t>(B19200));
  EXPECT_EQ(settings.c_iflag, 0U);
  EXPECT_EQ(settings.c_oflag & static_cast<tcflag_t>(OPOST), 0U);
  EXPECT_EQ(settings.c_lflag & static_cast<tcflag_t>(ICANON | ECHO | ECHONL | ISIG | IEXTEN), 0U);
  EXPECT_EQ(settings.c_cflag & static_cast<tcflag_t>(CSIZE | CSTOPB | PARENB | CRTSCTS | CLOCAL | CREAD),
            static_cast<tcflag_t>(CS8 | CLOCAL | CREAD));
  cable.write("$06M\r");
  EXPECT_EQ(cable.read_line(), "!069052\r");
}

TEST(SerialPort, IsSetToTheLineFormat) {
  const Cable cable;
  SimulatorProcess simulator({"EX9042D@05,format=8N2", "--port", "serial:" + cable.device()});
  EXPECT_EQ(cable.settings().c_cflag & static_cast<tcflag_t>(CSIZE | CSTOPB | PARENB),
            static_cast<tcflag_t>(CS8 | CSTOPB));
  cable.write("$05M\r");
  EXPECT_EQ(cable.read_line(), "!059042D\r");
}

// A pseudo-terminal has no parity.
TEST(SerialPort, APortThatCannotHaveTheLineFormatIsRefused) {
  const Cable cable;
  expect_refused(run({simulator_path(), "EX9042D", "--port", "serial:" + cable.device(), "--format", "8E1"}),
                 "--port: " + cable.device(), "cannot be set to 9600 baud 8E1");
}

// The 250 characters of the reply take more than a quarter of a second, so the program writes the reply in
// pieces.
TEST(SerialPort, ALongReplyIsSentCompletely) {
  const Cable cable;
  SimulatorProcess simulator({"EX9042D-M@05", "--port", "serial:" + cable.device()});
  std::string echo = std::string("\x05\x08\x00\x00", 4) + std::string(244, 'x');
  const Crc16 crc = crc16({reinterpret_cast<const std::uint8_t*>(echo.data()), echo.size()});
  echo += static_cast<char>(crc.low_byte());
  echo += static_cast<char>(crc.high_byte());
  cable.write(echo);
  EXPECT_EQ(cable.read(echo.size()), echo);
}

// In this test, the reply equals the request. Without --echo, the module would therefore receive the echo of
// its reply as a new request.
TEST(SerialPort, TheEchoOfAnAdapterIsIgnoredWithTheEchoOption) {
  const Cable cable;
  SimulatorProcess simulator({"EX9042D-M@01", "--port", "serial:" + cable.device() + ",echo"});
  const std::string switch_on("\x01\x05\x00\x00\xFF\x00\x8C\x3A", 8);
  for (int round = 0; round < 5; ++round) {
    cable.write(switch_on);
    EXPECT_EQ(cable.read(switch_on.size()), switch_on);
    cable.write(switch_on.substr(0, 3));  // the echo of the reply
    cable.write(switch_on.substr(3));
  }
  const std::string read_outputs("\x01\x01\x00\x00\x00\x0D\xFD\xCF", 8);
  cable.write(read_outputs);
  EXPECT_EQ(cable.read(7).substr(0, 5), std::string("\x01\x01\x02\x01\x00", 5));
}

TEST(SerialPort, TheProgramEndsWithAnErrorWhenThePortDisappears) {
  Cable cable;
  const Directory directory;
  ChildProcess simulator({simulator_path(), "EX9042D", "--port", "serial:" + cable.device()},
                         directory.path(), ChildProcess::Errors::WithOutput);
  ASSERT_TRUE(simulator.wait_for("press Ctrl-C to end"));
  cable.pull();
  EXPECT_EQ(simulator.wait(), 1);
  EXPECT_NE(simulator.output().find("--port: " + cable.device()), std::string::npos) << simulator.output();
  EXPECT_NE(simulator.output().find("the port has disappeared"), std::string::npos) << simulator.output();
}

TEST(SerialPort, AMissingUnsuitableOrUsedPortIsRefused) {
  expect_refused(run({simulator_path(), "EX9042D", "--port", "serial:/no/such/port"}),
                 "--port: /no/such/port", "name", kUnavailable);
  expect_refused(run({simulator_path(), "EX9042D", "--port", "serial:/dev/null"}), "--port: /dev/null",
                 "is not a serial port; name one, for example /dev/ttyUSB0");
  const Cable cable;
  const int holder = open(cable.device().c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  ASSERT_EQ(flock(holder, LOCK_EX | LOCK_NB), 0);
  expect_refused(run({simulator_path(), "EX9042D", "--port", "serial:" + cable.device()}),
                 "--port: " + cable.device(), "is in use by another program", kUnavailable);
  close(holder);
}

}  // namespace
}  // namespace ex9000::system
