// Tests the running program with the lines of a bus file and with a line of the command line: ports, threads,
// faults, inputs, EEPROM files, logs and error messages.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <sstream>
#include <string>
#include <system_error>
#include <thread>
#include <vector>

#include "tests/support/control_client.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/hang.hpp"
#include "tests/support/simulator_process.hpp"
#include "tests/support/socket_client.hpp"
#include "tests/support/terminal.hpp"

namespace ex9000::system {
namespace {

namespace fs = std::filesystem;
using std::chrono::milliseconds;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// A bus file in its own temporary directory.
class BusFile {
 public:
  explicit BusFile(const std::string& text) { write_file(path(), text); }
  [[nodiscard]] std::string path() const { return directory_ / "bus.json"; }

 private:
  Directory directory_;
};

/// Runs the program with a bus file and a control socket.
class Lines {
 public:
  explicit Lines(const std::string& text, const std::vector<std::string>& more = {})
      : file_(text), process_(arguments(file_.path(), more)) {}

  SimulatorProcess& process() { return process_; }
  [[nodiscard]] std::string operator/(const std::string& name) const {
    return process_.directory() + "/" + name;
  }
  ControlClient& control() { return control_; }
  /// Returns a TCP port from the greeting. `count` is the index of the port, from 0.
  [[nodiscard]] std::uint16_t tcp_port(int count) const {
    const std::string lead = "TCP 127.0.0.1:";
    auto at = process_.output().find(lead);
    for (; count > 0; --count) {
      at = process_.output().find(lead, at + 1);
    }
    return static_cast<std::uint16_t>(std::stoul(process_.output().substr(at + lead.size())));
  }

 private:
  static std::vector<std::string> arguments(const std::string& path, const std::vector<std::string>& more) {
    std::vector<std::string> words{path, "--control", "control"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }

  BusFile file_;
  SimulatorProcess process_;
  ControlClient control_{process_.directory() + "/control"};
};

constexpr const char* kHallAndYard = R"({"lines": [
  {"name": "hall", "port": ["pty:hall.tty", "tcp:0"], "timing": "instant",
   "modules": [{"model": "EX9042D", "address": "01"}, {"model": "EX9055D", "address": "02"}]},
  {"name": "yard", "port": ["pty:yard.tty", "tcp:0"], "timing": "instant",
   "modules": [{"model": "EX9052D", "address": "01"}]}]})";

/// By default, Debian permits 128 inotify instances for each user.
TEST(Lines, ThePseudoTerminalsShareOneInotifyInstance) {
  Lines lines(kHallAndYard);
  int instances = 0;
  for (const auto& file : fs::directory_iterator("/proc/" + std::to_string(lines.process().pid()) + "/fd")) {
    std::error_code closed_meanwhile;
    instances += fs::read_symlink(file.path(), closed_meanwhile) == "anon_inode:inotify" ? 1 : 0;
  }
  EXPECT_EQ(instances, 1);
}

/// Reads until at least `size` bytes have arrived. Returns fewer only if the program hangs or ends.
std::vector<std::uint8_t> read_exactly(Terminal& terminal, std::size_t size) {
  std::vector<std::uint8_t> bytes;
  while (bytes.size() < size) {
    const std::vector<std::uint8_t> more = terminal.read(kHang);
    if (more.empty()) {
      break;
    }
    bytes.insert(bytes.end(), more.begin(), more.end());
  }
  return bytes;
}

std::string ask(Terminal& terminal, const std::string& command) {
  terminal.type(command + "\r");
  const std::string reply = terminal.read_line();
  return reply.substr(0, reply.find('\r'));
}

// --- several lines ---

TEST(Lines, ALineDoesNotReceiveTheBytesOfAnotherLine) {
  Lines lines(kHallAndYard);
  Terminal hall(lines / "hall.tty", 9600);
  Terminal yard(lines / "yard.tty", 9600);
  SocketClient hall_tcp(lines.tcp_port(0));
  SocketClient yard_tcp(lines.tcp_port(1));
  hall_tcp.send("$01M\r");
  EXPECT_EQ(hall_tcp.receive_text(9), "!019042D\r");
  EXPECT_EQ(hall.read_line(), "!019042D\r");
  yard_tcp.send("$01M\r");  // bytes from the other line would arrive before the reply
  EXPECT_EQ(yard_tcp.receive_text(8), "!019052\r");
  EXPECT_EQ(yard.read_line(), "!019052\r");
  EXPECT_EQ(ask(yard, "$01F"), "!01D01.00");
  EXPECT_EQ(ask(hall, "$02M"), "!029055");
  EXPECT_TRUE(
      hall.read(milliseconds(50))
          .empty());  // on a busy machine this check can miss an error; it fails only if there is an error
}

TEST(Lines, EachLineHasItsOwnBaudRateAndItsNameInTheLog) {
  Lines lines(R"({"lines": [
    {"name": "hall", "port": "pty:hall.tty", "modules": [{"model": "EX9042D", "baud": 9600}]},
    {"port": "pty:yard.tty", "modules": [{"model": "EX9052D", "baud": 115200}]}], "log": true})");
  EXPECT_TRUE(has(lines.process().output(), "hall at 9600 baud 8N1:\n")) << lines.process().output();
  EXPECT_TRUE(has(lines.process().output(), "line2 at 115200 baud 8N1:\n")) << lines.process().output();
  Terminal yard(lines / "yard.tty", 115200);
  EXPECT_EQ(ask(yard, "$01M"), "!019052");
  Terminal hall(lines / "hall.tty", 9600);
  EXPECT_EQ(ask(hall, "$01M"), "!019042D");
  EXPECT_TRUE(lines.process().wait_for("!019042D"));
  std::string yards;
  std::string halls;
  std::istringstream printed(lines.process().output());
  for (std::string line; std::getline(printed, line);) {
    yards += has(line, "$01M") && line.rfind("line2: ", 0) == 0 ? "x" : "";
    halls += has(line, "$01M") && line.rfind("hall: ", 0) == 0 ? "x" : "";
  }
  EXPECT_EQ(yards, "x");
  EXPECT_EQ(halls, "x");
}

TEST(Lines, TheRepliesAndTheLogAreCorrectIfAllLinesAreBusy) {
  constexpr int kRequests = 50;
  {
    Lines lines(R"({"lines": [
      {"port": "tcp:0", "timing": "instant", "modules": [{"model": "EX9042D"}, {"model": "EX9052D", "address": "02"}]},
      {"port": "tcp:0", "timing": "instant", "modules": [{"model": "EX9042D"}]},
      {"port": "tcp:0", "timing": "instant", "modules": [{"model": "EX9042D"}]}]})",
                {"--log", "--capture", "lines.pcapng"});
    std::vector<std::string> wrong(3);
    std::vector<std::thread> masters;
    for (int line = 0; line < 3; ++line) {
      masters.emplace_back([&wrong = wrong[static_cast<std::size_t>(line)], port = lines.tcp_port(line)] {
        SocketClient master(port);
        for (int i = 0; i < kRequests; ++i) {
          master.send("$01M\r");
          const std::string reply = master.receive_text(9);
          wrong += reply == "!019042D\r" ? "" : reply + ",";
        }
      });
    }
    for (int i = 0; i < kRequests; ++i) {
      EXPECT_EQ(lines.control().ask(i % 2 == 0 ? "2 input 3 on" : "2 input 3 off"), "ok");
      EXPECT_EQ(lines.control().ask("2 inputs"), i % 2 == 0 ? "ok 0008" : "ok 0000");
    }
    for (std::thread& master : masters) {
      master.join();
    }
    EXPECT_EQ(wrong, std::vector<std::string>(3));
    EXPECT_TRUE(lines.process().wait_for("  < 01 EX9042D  !019042D\\r", 3 * kRequests));
    std::istringstream log(lines.process().output());
    for (std::string line; std::getline(log, line);) {
      EXPECT_TRUE(!has(line, "  < 01 EX9042D") || line.rfind("line", 0) == 0) << line;
    }
    EXPECT_EQ(lines.process().end(SIGTERM), 0);
  }
}

TEST(Lines, TheLinesOfTheExampleBusFileStartAndAModuleReplies) {
  std::string example = run({simulator_path(), "--example"}).output;
  for (const std::string port : {"tcp:5020", "modbus-tcp:5021"}) {
    ASSERT_TRUE(has(example, port));
    example.replace(example.find(port) + port.size() - 4, 4, "0");  // another program may use the port
  }
  example.replace(example.find("panel: on"), 9, "panel: 0");
  Lines lines(example);
  EXPECT_EQ(lines.control().ask("list"),
            "ok 4 modules: 1 EX9042D-M at 01 on hall, 2 EX9052D-M at 02 on hall, 3 EX9068D-M at 0A on yard, "
            "4 EX9055D at 0B on yard");
  EXPECT_TRUE(
      has(lines.control().ask("line hall faults"), "ok 4 faults: 1 x0 1 lost-reply every 10th reply; "));
  SocketClient yard(lines.tcp_port(0));
  yard.send("$0BM\r");
  EXPECT_EQ(yard.receive_text(8), "!0B9055\r");
  EXPECT_EQ(fs::file_size(lines / "hall-01.bin"), 8192U);
}

TEST(Lines, NoFilesAreCreatedIfOneLineFails) {
  const std::pair<const char*, int> cases[] = {{R"("port": "pty:taken")", 2},
                                               {R"("port": "pty:missing/tty")", 2},
                                               {R"("port": "tcp:192.0.2.1:5020")", 1},
                                               {R"("port": "serial:missing")", 1}};
  for (const auto& [wrong, status] : cases) {
    const Directory directory;
    write_file(directory / "taken", "precious");
    const BusFile file(R"({"control": "control", "lines": [
      {"port": "pty:a.tty", "modules": [{"model": "EX9042D", "eeprom": "first"}]},
      {)" + std::string(wrong) +
                       R"(, "modules": [{"model": "EX9042D", "eeprom": "second"}]}]})");
    const auto before = directory.contents();
    const Finished finished = run({"timeout", "60", simulator_path(), file.path()}, directory.path());
    EXPECT_EQ(finished.status, status) << finished.error;
    EXPECT_EQ(std::count(finished.error.begin(), finished.error.end(), '\n'), 1) << finished.error;
    EXPECT_EQ(directory.contents(), before) << wrong;
  }
}

TEST(Lines, APortErrorNamesItsPlaceInTheBusFile) {
  const BusFile file(
      "{\"lines\": [\n"
      "{\"port\": \"tcp:0\", \"modules\": [{\"model\": \"EX9042D\"}]},\n"
      "{\"port\": \"pty:no/such/folder\", \"modules\": [{\"model\": \"EX9042D\"}]}]}");
  const Finished finished = run({simulator_path(), file.path()});
  EXPECT_EQ(finished.status, 2);
  EXPECT_EQ(finished.error, "ex9000-sim: " + file.path() +
                                ":3: port: no/such/folder: No such file or directory; name a path that can "
                                "be written\n");
}

TEST(Lines, AnErrorOfAnUnnamedPseudoTerminalNamesItsLine) {
  const Directory directory;
  write_file(directory / "line1.tty", "precious");
  const BusFile file("{\"lines\": [\n{\"modules\": [{\"model\": \"EX9042D\"}]}]}");
  const Finished finished = run({simulator_path(), file.path()}, directory.path());
  EXPECT_EQ(finished.status, 2);
  EXPECT_EQ(finished.error, "ex9000-sim: " + file.path() +
                                ":2: port: line1.tty: exists and is not a link to a pseudo-terminal; "
                                "remove it or name another path\n");
}

TEST(Lines, AnEepromErrorNamesItsPlaceInTheBusFile) {
  const Directory directory;
  write_file(directory / "short", "short");
  write_file(directory / "steps.txt", "> $01M\n< !019042D\n");
  const BusFile file(
      "{\"lines\": [{\"port\": \"tcp:0\", \"modules\": [{\"model\": \"EX9042D\",\n\"eeprom\": "
      "\"short\"}]}]}");
  for (const std::vector<std::string>& command : {std::vector<std::string>{simulator_path(), file.path()},
                                                  {simulator_path(), "play", "steps.txt", file.path()}}) {
    const Finished finished = run(command, directory.path());
    EXPECT_EQ(finished.status, 2);
    EXPECT_EQ(finished.error.rfind("ex9000-sim: " + file.path() + ":2: eeprom: short: has 5 bytes, ", 0), 0U)
        << finished.error;
  }
}

TEST(Lines, ErrorsInSettingsForAllLinesNameTheBusFileOrTheOption) {
  const SimulatorProcess other({"EX9042D", "--panel", "0"});
  const std::string address = other.output().substr(0, other.output().find("/\n"));
  const std::string port = address.substr(address.rfind(':') + 1);
  const std::pair<std::string, std::string> cases[] = {
      {"control", "no/such/folder"}, {"capture", "no/such/folder"}, {"panel", port}};
  for (const auto& [key, wrong] : cases) {
    const Directory directory;
    const BusFile file("{\n\"" + key + "\": \"" + wrong +
                       "\", \"lines\": [{\"port\": \"tcp:0\", \"modules\": [{\"model\": \"EX9042D\"}]}]}");
    const Finished finished = run({simulator_path(), file.path()}, directory.path());
    EXPECT_EQ(finished.status, key == "panel" ? 1 : 2);  // the port is in use
    EXPECT_EQ(finished.error.rfind("ex9000-sim: " + file.path() + ":2: " + key + ": " + wrong + ": ", 0), 0U)
        << finished.error;
    const Finished asked = run({simulator_path(), file.path(), "--" + key, wrong}, directory.path());
    EXPECT_EQ(asked.error.rfind("ex9000-sim: --" + key + ": " + wrong + ": ", 0), 0U) << asked.error;
    EXPECT_TRUE(fs::is_empty(directory.path()));
  }
}

// --- one line on the command line ---

TEST(LineOfTheCommandLine, RunsTheFaultsAndInputProgramsOfItsOptions) {
  SimulatorProcess simulator({"EX9042D@01,fault=late-reply 20ms",
                              "EX9052D@02,input=5 square 2ms,fault=gone at 1h", "--timing", "instant",
                              "--control", "control"});
  ControlClient control(simulator.directory() + "/control");
  EXPECT_EQ(control.ask("faults"), "ok 2 faults: 1* x1 1 late-reply 20ms; 2 x0 2 gone at 1h");
  Terminal terminal(simulator.tty(), 9600);
  EXPECT_EQ(ask(terminal, "$01M"),
            "!019042D");  // the square wave has ten periods in the 20 ms before the reply
  const std::string some = ask(terminal, "#025");
  EXPECT_EQ(some.rfind("!02", 0), 0U);
  EXPECT_GT(std::stoul(some.substr(3)), 5U);
}

// Some faults attach their own stations to the bus. The log has no names for these stations.
TEST(LineOfTheCommandLine, BytesOfFaultsReachTheMasterAndForeignTrafficIsLogged) {
  SimulatorProcess simulator({"EX9042D-M@01", "--control", "control", "--log"});
  ControlClient control(simulator.directory() + "/control");
  Terminal terminal(simulator.tty(), 9600);
  for (int round = 0; round < 3; ++round) {
    control.ok("fault foreign-traffic 0501000000083C48");
    EXPECT_EQ(read_exactly(terminal, 8), (std::vector<std::uint8_t>{5, 1, 0, 0, 0, 8, 0x3C, 0x48}));
    terminal.write({1, 1, 0, 0, 0, 13, 0xFD, 0xCF});
    EXPECT_EQ(read_exactly(terminal, 7).size(), 7U);
  }
  EXPECT_TRUE(simulator.wait_for("? unknown sender  05 01 00 00 00 08 3C 48")) << simulator.output();
  control.ok("fault inserted-bytes 1");
  terminal.write({0});
  EXPECT_FALSE(terminal.read(kHang).empty());
  control.ok("fault echo 2ms");
  control.ok("fault off 4");
  terminal.write({0});
  EXPECT_FALSE(terminal.read(kHang).empty());
  EXPECT_EQ(simulator.end(SIGTERM), 0);
}

TEST(LineOfTheCommandLine, TheBeginningAndTheEndOfAFaultArePrintedWithTheirTimes) {
  SimulatorProcess simulator({"EX9042D", "--fault", "gone at 300ms for 100ms"});
  EXPECT_TRUE(simulator.wait_for("fault 1 occurs: gone at 300ms for 100ms")) << simulator.output();
  EXPECT_TRUE(simulator.wait_for("fault 1 is over: gone at 300ms for 100ms")) << simulator.output();
  EXPECT_TRUE(has(simulator.output(), "    0.300000  - fault 1 occurs")) << simulator.output();
  EXPECT_TRUE(has(simulator.output(), "    0.400000  - fault 1 is over")) << simulator.output();
}

}  // namespace
}  // namespace ex9000::system
