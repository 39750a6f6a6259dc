// Tests the control socket of the program: commands and replies, clients that misbehave, the end of the
// program, and the path of the socket.
#include <gtest/gtest.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/support/control_client.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/simulator_process.hpp"
#include "tests/support/terminal.hpp"

namespace ex9000::system {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostClients = 64;
/// The timeout for a reply on the line. It expires only if the program hangs.
constexpr std::chrono::seconds kReplyTimeout{60};

/// Runs the program with a control socket and an instant line.
class Simulator : public SimulatorProcess {
 public:
  explicit Simulator(const std::vector<std::string>& modules) : SimulatorProcess(arguments(modules)) {}

  [[nodiscard]] std::string socket() const { return directory() + "/control"; }

 private:
  static std::vector<std::string> arguments(std::vector<std::string> words) {
    words.insert(words.end(), {"--control", "control", "--timing", "instant"});
    return words;
  }
};

bool starts_with(const std::string& text, const std::string& start) { return text.rfind(start, 0) == 0; }

/// Runs the program in `directory` until the program ends. If it still runs after 60 s, the command `timeout`
/// ends it, and the status is 124.
Finished finish(std::vector<std::string> arguments, const std::string& directory) {
  arguments.insert(arguments.begin(), {"timeout", "60", simulator_path()});
  return run(arguments, directory);
}

/// Expects that the program does not start: exit status `status`, no standard output, one line on standard
/// error that names `path`, and no change in `directory`.
void expect_refused(const std::string& path, const Directory& directory, int status = 2) {
  const auto before = directory.contents();
  const Finished finished = finish({"EX9042D,eeprom=image", "--control", path}, directory.path());
  EXPECT_EQ(finished.status, status) << path;
  EXPECT_EQ(finished.output, "");
  EXPECT_NE(finished.error.find("--control: " + path), std::string::npos) << finished.error;
  EXPECT_EQ(std::count(finished.error.begin(), finished.error.end(), '\n'), 1) << finished.error;
  EXPECT_EQ(directory.contents(), before) << path;
}

std::string lines(const std::string& line, std::size_t count) {
  std::string text;
  for (std::size_t i = 0; i < count; ++i) {
    text += line + "\n";
  }
  return text;
}

bool is_answered(ControlClient& client) {
  try {
    return client.ask("1 led") == "ok on";
  } catch (const std::runtime_error&) {
    return false;
  }
}

std::size_t answered(const std::vector<std::unique_ptr<ControlClient>>& clients) {
  return static_cast<std::size_t>(
      std::count_if(clients.begin(), clients.end(), [](const auto& client) { return is_answered(*client); }));
}

std::vector<std::unique_ptr<ControlClient>> connect(const std::string& path, std::size_t count) {
  std::vector<std::unique_ptr<ControlClient>> clients;
  for (std::size_t i = 0; i < count; ++i) {
    clients.push_back(std::make_unique<ControlClient>(path));
  }
  return clients;
}

/// Expects that the module replies on the line, and that the control socket replies.
void expect_undisturbed(const Simulator& simulator) {
  Terminal terminal(simulator.tty(), 9600);
  terminal.type("$01M\r");
  EXPECT_EQ(terminal.read_line(kReplyTimeout), "!019055\r");
  EXPECT_EQ(ControlClient(simulator.socket()).ask("1 led"), "ok on");
}

// --- commands and replies ---

TEST(ControlSocket, CommandsSetInputsAndReadOutputsOfAModule) {
  Simulator simulator({"EX9055D"});
  ControlClient client(simulator.socket());
  Terminal terminal(simulator.tty(), 9600);
  EXPECT_EQ(client.ask("1 input 5 on"), "ok");
  EXPECT_EQ(client.ask("1 pulse 0 x1234"), "ok");
  terminal.type("@01\r");
  EXPECT_EQ(terminal.read_line(kReplyTimeout), ">0020\r");
  terminal.type("#010\r");
  EXPECT_EQ(terminal.read_line(kReplyTimeout), "!0101234\r");
  terminal.type("@0181\r");
  EXPECT_EQ(terminal.read_line(kReplyTimeout), ">\r");
  EXPECT_EQ(std::stoul(client.ok("1 outputs"), nullptr, 16), 0x81U);
}

TEST(ControlSocket, CommandsInOneWriteAreAnsweredInTheirOrder) {
  Simulator simulator({"EX9055D"});
  ControlClient client(simulator.socket());
  client.send("1 input 0 on\n1 inputs\nbogus\n1 input 1 on\r\n1 inputs\n\nlist\n1 input 0 off\n1 inputs\n");
  EXPECT_EQ(client.line(), "ok");
  EXPECT_EQ(client.line(), "ok 0001");
  EXPECT_TRUE(starts_with(client.line(), "error: "));
  EXPECT_EQ(client.line(), "ok");
  EXPECT_EQ(client.line(), "ok 0003");
  EXPECT_TRUE(starts_with(client.line(), "error: "));
  EXPECT_TRUE(starts_with(client.line(), "ok 1 module"));
  EXPECT_EQ(client.line(), "ok");
  EXPECT_EQ(client.line(), "ok 0002");
}

TEST(ControlSocket, ACommandMayArriveInPieces) {
  Simulator simulator({"EX9055D"});
  ControlClient other(simulator.socket());
  ControlClient client(simulator.socket());
  for (const char character : std::string("1 input 4 on")) {
    client.send(std::string(1, character));
    EXPECT_EQ(other.ask("1 inputs"), "ok 0000");  // before this reply, the program reads the piece
  }
  client.send("\n");
  EXPECT_EQ(client.line(), "ok");
  EXPECT_EQ(other.ask("1 inputs"), "ok 0010");
}

// --- clients that misbehave ---

TEST(ControlSocket, ACommandOfMoreThan1000CharactersIsRefusedAndDisconnectsOnlyItsClient) {
  Simulator simulator({"EX9055D"});
  ControlClient other(simulator.socket());
  EXPECT_EQ(other.ask("1 led" + std::string(995, ' ')), "ok on");
  for (const std::size_t size : {1001U, 5000U, 20'000U}) {
    ControlClient client(simulator.socket());
    client.send("1 led\n" + std::string(size, 'x') + "\n1 power off\n");
    EXPECT_EQ(client.line(), "ok on") << size;
    EXPECT_EQ(client.line(), "error: the command is too long; expected up to 1000 characters") << size;
    EXPECT_TRUE(client.at_end()) << size;
    EXPECT_EQ(other.ask("1 led"), "ok on") << size;
  }
  expect_undisturbed(simulator);
}

TEST(ControlSocket, AnIncompleteCommandOfADisconnectedClientIsIgnored) {
  Simulator simulator({"EX9055D"});
  for (const char* piece : {"1 power off", "1 power o", "quit", "1"}) {
    ControlClient(simulator.socket()).send(piece);
    expect_undisturbed(simulator);
  }
}

TEST(ControlSocket, AMissingFinalNewlineIsReportedToTheClient) {
  Simulator simulator({"EX9055D"});
  ControlClient client(simulator.socket());
  client.send("1 led\n1 power off");
  client.close_writing();
  EXPECT_EQ(client.line(), "ok on");
  EXPECT_EQ(client.line(), "error: the last command was ignored; expected a newline after it");
  EXPECT_TRUE(client.at_end());
  expect_undisturbed(simulator);
}

TEST(ControlSocket, CommandsOfAClientThatDisconnectsImmediatelyAreExecuted) {
  Simulator simulator({"EX9055D"});
  ControlClient(simulator.socket()).send("1 input 0 on\n1 input 7 on\n");
  ControlClient other(simulator.socket());
  std::string inputs;
  // The program may reply to `other` before it has carried out both commands of the first client.
  for (int turn = 0; inputs != "ok 0081" && turn < 100; ++turn) {
    inputs = other.ask("1 inputs");
  }
  EXPECT_EQ(inputs, "ok 0081");
}

TEST(ControlSocket, AClientThatDoesNotReadIsThrottledAndOthersGetTheirReplies) {
  Simulator simulator({"EX9055D"});
  ControlClient other(simulator.socket());
  const std::string command = "1 status\n";
  std::size_t sent = 0;
  {
    ControlClient deaf(simulator.socket());
    std::size_t refusals = 0;
    // While the test waits for the reply to `other`, the program has time to read from `deaf`. Therefore, if
    // `deaf` could not send a byte at 100 attempts, the program has stopped reading from `deaf`.
    while (refusals < 100) {
      const std::size_t taken = deaf.offer(command);
      sent += taken / command.size();
      refusals += taken == 0 ? 1 : 0;
      ASSERT_EQ(other.ask("1 led"), "ok on");
      ASSERT_LT(sent, 100'000U);
    }
    EXPECT_GT(sent, 100U);
    expect_undisturbed(simulator);
    for (std::size_t i = 0; i < sent; ++i) {
      ASSERT_TRUE(starts_with(deaf.line(), "ok EX9055D")) << i;  // no reply is lost
    }
    while (deaf.offer(command) != 0) {
    }
  }
  expect_undisturbed(simulator);
}

TEST(ControlSocket, AtMost64ClientsAreServedAndFurtherClientsAreDisconnected) {
  Simulator simulator({"EX9055D"});
  auto clients = connect(simulator.socket(), 100);
  EXPECT_EQ(answered(clients), kMostClients);
  EXPECT_EQ(answered(clients), kMostClients);  // the accepted clients stay connected
  EXPECT_EQ(ControlClient(simulator.socket()).line(),
            "error: there are 64 clients already; close one of them");
  clients.resize(1);
  ASSERT_TRUE(is_answered(*clients[0]));  // before this reply, the program notices the closed connections
  const auto heirs = connect(simulator.socket(), 100);
  EXPECT_EQ(answered(heirs), kMostClients - 1);
  EXPECT_TRUE(is_answered(*clients[0]));
}

TEST(ControlSocket, ClosedConnectionsLeakNoFileDescriptors) {
  Simulator simulator({"EX9055D"});
  for (int i = 0; i < 1500; ++i) {  // more than 1024, the usual limit for the open files of a process
    ControlClient client(simulator.socket());
    if (i % 2 == 0) {
      client.send("1 led");
    } else {
      ASSERT_EQ(client.ask("1 led"), "ok on") << i;
    }
  }
  expect_undisturbed(simulator);
}

// --- the end of the program ---

TEST(ControlSocket, QuitEndsTheProgramWithStatus0AndRemovesLinkAndSocket) {
  Simulator simulator({"EX9055D"});
  EXPECT_NE(simulator.output().find("control socket control\n"), std::string::npos) << simulator.output();
  ControlClient onlooker(simulator.socket());
  ControlClient client(simulator.socket());
  EXPECT_EQ(client.ask("quit"), "ok");
  EXPECT_EQ(simulator.wait(), 0);
  EXPECT_TRUE(client.at_end());
  EXPECT_TRUE(onlooker.at_end());
  EXPECT_TRUE(fs::is_empty(simulator.directory()));
}

TEST(ControlSocket, QuitWorksWhileAnotherClientDoesNotRead) {
  Simulator simulator({"EX9055D"});
  ControlClient deaf(simulator.socket());
  const std::string flood = lines("1 status", 1000);
  while (deaf.offer(flood) != 0) {
  }
  ControlClient(simulator.socket()).send("quit\n");
  EXPECT_EQ(simulator.wait(), 0);
  EXPECT_TRUE(fs::is_empty(simulator.directory()));
}

TEST(ControlSocket, SigintSigtermAndSighupEndTheProgramAndRemoveLinkAndSocket) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    Simulator simulator({"EX9055D"});
    ControlClient client(simulator.socket());
    EXPECT_EQ(simulator.end(signal), 0);
    EXPECT_TRUE(client.at_end());
    EXPECT_TRUE(fs::is_empty(simulator.directory()));
  }
}

TEST(ControlSocket, AFileThatReplacedTheSocketIsNotRemoved) {
  Simulator simulator({"EX9055D"});
  fs::remove(simulator.socket());
  write_file(simulator.socket(), "precious");
  EXPECT_EQ(simulator.end(SIGTERM), 0);
  EXPECT_EQ(bytes_of_file(simulator.socket()), "precious");
}

// --- the path ---

TEST(ControlSocket, TheSocketOfAKilledProcessIsReplaced) {
  Simulator dead({"EX9055D"});
  EXPECT_EQ(dead.end(SIGKILL), 128 + SIGKILL);
  ASSERT_TRUE(fs::is_socket(dead.socket()));
  SimulatorProcess heir({"EX9055D", "--port", "pty:" + dead.tty(), "--control", dead.socket()});
  EXPECT_EQ(ControlClient(dead.socket()).ask("1 led"), "ok on");
  EXPECT_EQ(heir.end(SIGTERM), 0);
  EXPECT_TRUE(fs::is_empty(dead.directory()));
}

TEST(ControlSocket, ASocketInUseIsRefusedAndContinuesToWork) {
  Simulator simulator({"EX9055D"});
  const Directory directory;
  expect_refused(simulator.socket(), directory, 1);
  expect_undisturbed(simulator);
  const auto clients = connect(simulator.socket(), kMostClients);  // uses all connections
  expect_refused(simulator.socket(), directory, 1);
  EXPECT_TRUE(is_answered(*clients[0]));
}

TEST(ControlSocket, AFileThatIsNotASocketIsRefusedAndNotRemoved) {
  const Directory directory;
  write_file(directory / "file", "precious");
  write_file(directory / "empty", "");
  fs::create_directory(directory / "directory");
  fs::create_symlink(directory / "file", directory / "symlink");
  fs::create_symlink(directory / "nowhere", directory / "dangling");
  ASSERT_EQ(mkfifo((directory / "fifo").c_str(), 0644), 0);
  for (const char* name : {"file", "empty", "directory", "symlink", "dangling", "fifo"}) {
    expect_refused(name, directory);
  }
  expect_refused("/dev/null", directory);
}

TEST(ControlSocket, ADatagramSocketAtThePathIsRefusedAndNotRemoved) {
  const Directory directory;
  const int datagrams = socket(AF_UNIX, SOCK_DGRAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  (directory / "datagrams").copy(address.sun_path, sizeof address.sun_path - 1);
  ASSERT_EQ(bind(datagrams, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  expect_refused("datagrams", directory);
  close(datagrams);
}

TEST(ControlSocket, TheSocketOfAProgramThatListensButAcceptsNothingIsNotReplaced) {
  const Directory directory;
  const int listener = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  (directory / "busy").copy(address.sun_path, sizeof address.sun_path - 1);
  const auto* name = reinterpret_cast<const sockaddr*>(&address);
  ASSERT_EQ(bind(listener, name, sizeof address), 0);
  ASSERT_EQ(listen(listener, 0), 0);
  const int waiting = socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0);
  ASSERT_EQ(connect(waiting, name, sizeof address), 0);  // the queue of connections is full now
  const Finished finished =
      run({"timeout", "60", simulator_path(), "EX9055D", "--control", "busy"}, directory.path());
  EXPECT_EQ(finished.status, 1);
  EXPECT_NE(finished.error.find("busy: another program listens there"), std::string::npos) << finished.error;
  close(waiting);
  close(listener);
}

TEST(ControlSocket, APathThatCannotBeCreatedIsRefusedAndNoFileRemains) {
  const Directory directory;
  for (const std::string& path : {std::string("missing/control"), std::string("/proc/control"),
                                  std::string(108, 'x'), std::string(300, 'x')}) {
    expect_refused(path, directory);
  }
}

TEST(ControlSocket, APathOfMaximumLengthIsAccepted) {
  const std::string name(107, 'x');
  SimulatorProcess simulator({"EX9055D", "--control", name});
  fs::create_symlink(name, simulator.directory() + "/short");
  EXPECT_EQ(ControlClient(simulator.directory() + "/short").ask("1 led"), "ok on");
  EXPECT_EQ(simulator.end(SIGTERM), 0);
  EXPECT_FALSE(fs::exists(simulator.directory() + "/" + name));
}

}  // namespace
}  // namespace ex9000::system
