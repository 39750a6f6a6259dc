// Tests boards/lm3s6965evb/run as a user starts it: the shipped image on a pseudo-terminal.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <modbus/modbus.h>
#include <poll.h>
#include <sys/inotify.h>
#include <sys/ioctl.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "firmware/hex.hpp"
#include "tests/masters/libmodbus_master.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/free_port.hpp"
#include "tests/support/socket_client.hpp"
#include "tests/support/terminal.hpp"

namespace ex9000::system {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

const std::string kRun = EX9000_RUN;
constexpr std::size_t kEepromSize = 8192;
/// A limit that only detects hangs: the program and QEMU answer within seconds even on a busy machine.
constexpr std::chrono::seconds kHang{60};
/// The time that a master waits for a reply, long enough for a busy machine.
constexpr std::chrono::seconds kMasterReplyTimeout{10};

std::string image_of(const std::string& model) { return EX9000_IMAGES "/" + model + ".elf"; }
bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// A running image of a model.
class RunningImage {
 public:
  explicit RunningImage(const std::string& model, const Arguments& options = {})
      : process_(words(model, options), directory_.path()) {
    if (!process_.wait_for("press Ctrl-C to end")) {
      throw std::runtime_error(model + " does not run");
    }
  }

  /// Returns the first line of its output, which names the terminal.
  [[nodiscard]] std::string tty() const { return process_.output().substr(0, process_.output().find('\n')); }
  ChildProcess& process() { return process_; }
  [[nodiscard]] int qemu() const {
    const std::string pid = std::to_string(process_.pid());
    std::ifstream children("/proc/" + pid + "/task/" + pid + "/children");
    int child = -1;
    children >> child;
    return child;
  }

  /// Sends a command and its CR, and returns the answer up to CR.
  [[nodiscard]] std::string ask(const std::string& command) const { return ask_behind("", command); }
  /// Like `ask`, but first skips answers to earlier requests, which are all `before`.
  [[nodiscard]] std::string ask_behind(const std::string& before, const std::string& command) const {
    Terminal terminal(tty(), 9600);
    terminal.type(command + "\r");
    std::string reply = terminal.read_line(kHang);
    while (!before.empty() && reply == before + "\r") {
      reply = terminal.read_line(kHang);
    }
    return reply.substr(0, reply.find('\r'));
  }

  /// Runs mbpoll once.
  [[nodiscard]] Finished mbpoll(Arguments options, const Arguments& values = {}) const {
    options.insert(options.begin(), {"mbpoll", "-m", "rtu", "-b", "9600", "-P", "none", "-1", "-o",
                                     std::to_string(kMasterReplyTimeout.count())});
    options.push_back(tty());
    options.insert(options.end(), values.begin(), values.end());
    return system::run(options);
  }

 private:
  static Arguments words(const std::string& model, const Arguments& options) {
    Arguments words{kRun, image_of(model)};
    words.insert(words.end(), options.begin(), options.end());
    return words;
  }

  Directory directory_;
  ChildProcess process_;
};

/// Returns whether the process has ended. It may still have an entry that its parent has not read.
bool has_ended(int pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/stat");
  std::string number;
  std::string name;
  std::string state;
  status >> number >> name >> state;
  return !status || state == "Z";
}

/// Waits for the end of a process, which need not be a child of this one.
bool ends(int pid) {
  const int process = static_cast<int>(syscall(SYS_pidfd_open, pid, 0));
  pollfd over{process, POLLIN, 0};
  const bool ended = process < 0 || poll(&over, 1, std::chrono::milliseconds(kHang).count()) == 1;
  close(process);
  return ended && has_ended(pid);
}

// --- masters ---

TEST(QemuRun, MbpollReadsAndWrites) {
  const RunningImage image("EX9042D-M");
  EXPECT_TRUE(has(image.mbpoll({"-a", "1", "-t", "0", "-r", "3"}, {"1"}).output, "Written 1 references."));
  EXPECT_TRUE(has(image.mbpoll({"-a", "1", "-t", "0", "-r", "1", "-c", "13"}).output,
                  "[1]: \t0\n[2]: \t0\n[3]: \t1\n[4]: \t0\n[5]: \t0\n[6]: \t0\n[7]: \t0\n[8]: \t0\n"
                  "[9]: \t0\n[10]: \t0\n[11]: \t0\n[12]: \t0\n[13]: \t0\n"));
}

TEST(QemuRun, LibmodbusReadsAndWrites) {
  const RunningImage image("EX9042D-M");
  LibmodbusMaster master(image.tty(), 9600);
  master.wait_for_replies(static_cast<unsigned>(std::chrono::milliseconds(kMasterReplyTimeout).count()));
  modbus_t* const module = master.at(1);
  const std::array<std::uint8_t, 13> written{1, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  std::array<std::uint8_t, 13> read{};
  ASSERT_EQ(modbus_write_bits(module, 0, 13, written.data()), 13);
  ASSERT_EQ(modbus_read_bits(module, 0, 13, read.data()), 13);
  EXPECT_EQ(read, written);
  EXPECT_EQ(modbus_write_bit(module, 13, 1), -1);
  EXPECT_EQ(errno, EMBXILADD);
}

TEST(QemuRun, ACommandMayBeTypedByHand) {
  // A busy machine makes the pauses longer, which does not matter.
  constexpr std::chrono::milliseconds kBetweenKeys{50};
  const RunningImage image("EX9042D");
  Terminal terminal(image.tty(), 9600);
  for (const char key : std::string("$01M")) {
    terminal.type({key});
    EXPECT_TRUE(terminal.read(kBetweenKeys).empty());
  }
  terminal.type("\r");
  EXPECT_EQ(terminal.read_line(kHang), "!019042D\r");
}

TEST(QemuRun, MastersMayConnectAndDisconnectRepeatedly) {
  const RunningImage image("EX9042D");
  for (int visit = 0; visit < 20; ++visit) {
    EXPECT_EQ(image.ask("$01M"), "!019042D");
  }
}

/// Observes when any process opens or closes a terminal. The kernel merges successive equal events.
class Visits {
 public:
  explicit Visits(const std::string& tty) : fd_(inotify_init1(IN_CLOEXEC)) {
    EXPECT_GE(inotify_add_watch(fd_, tty.c_str(), IN_OPEN | IN_CLOSE), 0);
  }
  ~Visits() { close(fd_); }
  Visits(const Visits&) = delete;
  Visits& operator=(const Visits&) = delete;

  /// Waits for the next event of this kind.
  void wait_for(std::uint32_t kind) {
    pollfd ready{fd_, POLLIN, 0};
    inotify_event event{};  // of a file, so without a name
    do {
      ASSERT_EQ(poll(&ready, 1, std::chrono::milliseconds(kHang).count()), 1);
      ASSERT_EQ(read(fd_, &event, sizeof event), static_cast<ssize_t>(sizeof event));
    } while ((event.mask & kind) == 0);
  }

 private:
  int fd_;
};

/// Sends a command, waits for the whole reply, and leaves it unread. Returns when the program has emptied the
/// terminal.
void leave_reply_unread(const std::string& tty, const std::string& command, const std::string& reply) {
  std::optional<Visits> visits;
  {
    Terminal terminal(tty, 9600);
    const int fd = open(tty.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
    terminal.type(command + "\r");
    const auto gives_up = std::chrono::steady_clock::now() + kHang;
    std::size_t there = 0;
    while (there < reply.size() + 1 && std::chrono::steady_clock::now() < gives_up) {
      int count = 0;
      ioctl(fd, FIONREAD, &count);
      there = static_cast<std::size_t>(count);
    }
    EXPECT_EQ(there, reply.size() + 1);
    visits.emplace(tty);  // not earlier: the program may have emptied the terminal after an earlier visit
    close(fd);
  }
  // This function has closed the terminal. Then the program opens and closes it in order to empty it.
  visits->wait_for(IN_CLOSE);
  visits->wait_for(IN_OPEN);
  visits->wait_for(IN_CLOSE);
}

/// Repeats a request until its reply arrives, as a master does, because a module receives nothing while it
/// sends or hangs.
bool gets(const RunningImage& image, const std::string& command, const std::string& reply) {
  constexpr std::chrono::seconds kRepeats{1};  // a busy machine can only cause more requests
  Terminal terminal(image.tty(), 9600);
  const auto gives_up = std::chrono::steady_clock::now() + kHang;
  while (std::chrono::steady_clock::now() < gives_up) {
    terminal.type(command + "\r");
    for (std::string line = terminal.read_line(kRepeats); !line.empty();
         line = terminal.read_line(kRepeats)) {
      if (line == reply + "\r") {
        return true;
      }
    }
  }
  return false;
}

TEST(QemuRun, ARequestIsExecutedAfterItsMasterHasDisconnected) {
  const RunningImage image("EX9042D");
  Terminal(image.tty(), 9600).type("@010005\r");
  EXPECT_TRUE(gets(image, "@01", ">0005"));
}

TEST(QemuRun, TheNextMasterDoesNotReceiveAnUnreadReply) {
  const RunningImage image("EX9042D");
  for (int visit = 0; visit < 5; ++visit) {
    leave_reply_unread(image.tty(), "$01M", "!019042D");
    EXPECT_EQ(image.ask("$012"), "!01400600");
  }
}

TEST(QemuRun, AMasterThatNeverReadsDoesNotStopTheModule) {
  const RunningImage image("EX9042D");
  {
    Terminal terminal(image.tty(), 9600);
    for (int request = 0; request < 1000; ++request) {  // the answers need twice the buffer of a terminal
      terminal.type("$01M\r");
      // Leaves time for an answer. The expectations do not depend on requests that are lost.
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  EXPECT_TRUE(gets(image, "$012", "!01400600"));
}

// --- persistence ---

TEST(QemuRun, SettingsPersistInTheEepromFile) {
  const Directory directory;
  const Arguments options{"--eeprom", directory / "eeprom"};
  {
    RunningImage image("EX9042D-M", options);
    EXPECT_EQ(bytes_of_file(directory / "eeprom").size(), kEepromSize);
    const Finished written = image.mbpoll({"-a", "1", "-t", "4", "-r", "485"}, {"7"});  // 0x01E4, the address
    EXPECT_TRUE(has(written.output, "Written 1 references.")) << written.error;
    image.process().end(SIGKILL);
  }
  {
    const RunningImage image("EX9042D-M", options);
    EXPECT_TRUE(has(image.mbpoll({"-a", "7", "-t", "4", "-r", "485"}).output, "[485]: \t7"));
  }
  Arguments grounded = options;
  grounded.push_back("--init");
  EXPECT_EQ(RunningImage("EX9042D-M", grounded).ask("$002"), "!07400600");
  EXPECT_EQ(bytes_of_file(directory / "eeprom").size(), kEepromSize);
}

TEST(QemuRun, WithoutAnEepromFileEveryRunStartsWithFactorySettings) {
  EXPECT_EQ(RunningImage("EX9042D").ask("~01OPUMP"), "!01");
  EXPECT_EQ(RunningImage("EX9042D").ask("$01M"), "!019042D");
}

// --- resets ---

/// A debugger, which stops the processor while it is connected.
class Debugger {
 public:
  explicit Debugger(std::uint16_t port) : client_(port) {
    ask("qXfer:features:read:target.xml:0,fff");  // QEMU then allows writes to single registers
  }

  void write_memory(std::uint32_t address, const std::string& hex) {
    EXPECT_EQ(ask("M" + hex_of(address) + "," + std::to_string(hex.size() / 2) + ":" + hex), "OK");
  }
  void send_processor_to(std::uint32_t address) {
    EXPECT_EQ(ask("Pf=" + hex_of(__builtin_bswap32(address))), "OK");
  }
  void leave() { EXPECT_EQ(ask("D"), "OK"); }

 private:
  static std::string hex_of(std::uint32_t word) {
    std::array<char, 9> digits{};
    std::snprintf(digits.data(), digits.size(), "%08x", word);
    return digits.data();
  }

  /// Sends a command of GDB's remote protocol and returns the reply without its framing.
  std::string ask(const std::string& command) {
    unsigned sum = 0;
    for (const char character : command) {
      sum += static_cast<unsigned char>(character);
    }
    client_.send("$" + command + "#" + hex_of(sum & 0xFFU).substr(6));
    std::string reply = packet();
    while (!reply.empty() && reply[0] == 'T') {  // reports that the processor has stopped
      reply = packet();
    }
    return reply;
  }
  std::string packet() {
    const std::string text = (up_to('$'), up_to('#'));
    up_to_end_of_check();
    client_.send("+");
    return text;
  }
  std::string up_to(char end) {
    std::size_t at = received_.find(end);
    while (at == std::string::npos) {
      receive();
      at = received_.find(end);
    }
    const std::string text = received_.substr(0, at);
    received_.erase(0, at + 1);
    return text;
  }
  void up_to_end_of_check() {
    while (received_.size() < 2) {
      receive();
    }
    received_.erase(0, 2);
  }
  void receive() {
    const std::string more = client_.receive_text(1);
    if (more.empty()) {
      throw std::runtime_error("the debugger gets no answer");
    }
    received_ += more;
  }

  SocketClient client_;
  std::string received_;
};

/// If INIT* were low, the module would start in INIT mode and no longer answer to 01.
TEST(QemuRun, InitStaysReleasedWhenTheModuleResetsItself) {
  constexpr std::uint32_t kNothingThere = 0xF0000000;
  constexpr std::uint32_t kDeafLoop = 0x20008000;
  constexpr std::uint32_t kLoop = kDeafLoop + 2;
  const std::string port = std::to_string(free_port());
  const RunningImage image("EX9042D", {"--gdb", port});
  EXPECT_EQ(image.ask("$015"), "!011");
  // The first address causes a fault; the others make the program hang until the watchdog resets it.
  for (const std::uint32_t address : {kNothingThere, kLoop, kDeafLoop}) {
    EXPECT_EQ(image.ask("$015"), "!010");
    EXPECT_EQ(image.ask("@010005"), ">");
    Debugger debugger(static_cast<std::uint16_t>(std::stoi(port)));
    // The code is `cpsid i`, `b .`; neither data nor stack uses its address.
    debugger.write_memory(kDeafLoop, "72b6fee7");
    debugger.send_processor_to(address);
    debugger.leave();
    ASSERT_TRUE(gets(image, "$01M", "!019042D")) << address;
    EXPECT_EQ(image.ask_behind("!019042D", "$015"), "!011");
    EXPECT_EQ(image.ask("@01"), ">0000");
  }
}

// --- end of the program ---

TEST(QemuRun, EndsCleanlyOnASignalAndEndsQemu) {
  for (const int signal : {SIGINT, SIGTERM, SIGHUP}) {
    const Directory directory;
    RunningImage image("EX9042D", {"--link", directory / "tty"});
    EXPECT_EQ(fs::read_symlink(directory / "tty"), image.tty());
    const int qemu = image.qemu();
    ASSERT_FALSE(has_ended(qemu));
    EXPECT_EQ(image.process().end(signal), 0);
    EXPECT_TRUE(has_ended(qemu));
    EXPECT_TRUE(directory.contents().empty());
  }
}

TEST(QemuRun, QemuEndsWhenTheProgramIsKilled) {
  const Directory directory;
  const Arguments options{"--link", directory / "tty"};
  std::optional<Terminal> master;
  {
    RunningImage image("EX9042D", options);
    const int qemu = image.qemu();
    master.emplace(image.tty(),
                   9600);  // while it is open, no other terminal of this machine receives the same name
    image.process().end(SIGKILL);
    EXPECT_TRUE(ends(qemu));
  }
  const RunningImage next("EX9042D", options);  // takes over the link
  EXPECT_EQ(fs::read_symlink(directory / "tty"), next.tty());
}

TEST(QemuRun, EndsWhenQemuEnds) {
  const Directory directory;
  RunningImage image("EX9042D", {"--link", directory / "tty"});
  kill(image.qemu(), SIGKILL);
  EXPECT_EQ(image.process().wait(), 1);
  EXPECT_TRUE(directory.contents().empty());
}

// --- refusals ---

/// Expects one line of error output that contains `words`, and no new files in `directory`.
void expect_refusal(const Directory& directory, const Arguments& arguments, const Arguments& words,
                    int status = 2) {
  const auto before = directory.contents();
  Arguments command{"/usr/bin/python3", kRun};
  command.insert(command.end(), arguments.begin(), arguments.end());
  const Finished finished = system::run(command, directory.path());
  EXPECT_EQ(finished.status, status) << finished.error;
  EXPECT_EQ(finished.output, "");
  EXPECT_EQ(finished.error.find('\n'), finished.error.size() - 1) << finished.error;
  for (const std::string& word : words) {
    EXPECT_TRUE(has(finished.error, word)) << word << "\n" << finished.error;
  }
  EXPECT_EQ(directory.contents(), before);
}

TEST(QemuRun, RefusesAFileThatIsNotAnImageForThisBoard) {
  const Directory directory;
  expect_refusal(directory, {"none.elf"}, {"none.elf: No such file", "cmake --build --preset lm3s6965evb"});
  expect_refusal(directory, {"/"}, {"/: Is a directory"});
  write_file(directory / "text.elf", "no image");
  expect_refusal(directory, {"text.elf"}, {"text.elf: the file is not an ELF file for Arm"});
  expect_refusal(directory, {"/usr/bin/python3"}, {"/usr/bin/python3: the file is not an ELF file for Arm"});
  expect_refusal(directory, {EX9000_IMAGES "/EX9042D.bin"},
                 {"EX9042D.bin: the file is not an ELF file", "MODEL.elf"});

  std::string image = bytes_of_file(image_of("EX9042D"));
  const std::string top_of_ram("\x00\x00\x01\x20", 4);
  const std::string top_of_the_launchpads("\x00\x80\x00\x20", 4);
  image.replace(image.find(top_of_ram), top_of_ram.size(), top_of_the_launchpads);
  write_file(directory / "other.elf", image);
  expect_refusal(directory, {"other.elf"}, {"other.elf: the image is for another board", "lm3s6965evb"});
}

TEST(QemuRun, RefusesAnEepromFileThatItCannotUse) {
  const Directory directory;
  const std::string image = image_of("EX9042D");
  write_file(directory / "short", std::string(kEepromSize - 1, '\xFF'));
  expect_refusal(directory, {image, "--eeprom", "short"},
                 {"--eeprom short: the file has 8191 bytes", "8192", "remove"});
  expect_refusal(directory, {image, "--eeprom", "/"}, {"--eeprom /: Is a directory", "name a file"});
  expect_refusal(directory, {image, "--eeprom", "none/eeprom"}, {"--eeprom none/eeprom: No such file"});
  const RunningImage other("EX9042D", {"--eeprom", directory / "taken"});
  expect_refusal(directory, {image, "--eeprom", "taken"}, {"--eeprom taken: another run uses this file"});
}

TEST(QemuRun, RefusesALinkIfItsPathExists) {
  const Directory directory;
  const std::string image = image_of("EX9042D");
  write_file(directory / "file", "somebody's");
  fs::create_symlink("file", directory / "link");
  for (const std::string path : {"file", "link", "/"}) {
    expect_refusal(directory, {image, "--link", path},
                   {"--link " + path + ": the path exists already", "remove"});
  }
  expect_refusal(directory, {image, "--link", "none/tty"}, {"--link none/tty: No such file"});
  const RunningImage other("EX9042D", {"--link", directory / "taken"});
  expect_refusal(directory, {image, "--link", "taken"}, {"--link taken: the path exists already"});
}

TEST(QemuRun, ReportsTheErrorMessageOfQemu) {
  const Directory directory;
  const std::string port = std::to_string(free_port());
  const RunningImage other("EX9042D", {"--gdb", port});
  expect_refusal(directory, {image_of("EX9042D"), "--gdb", port}, {"qemu-system-arm has ended", "in use"}, 1);
}

TEST(QemuRun, NamesTheMissingPackage) {
  const Directory directory;
  const std::string path = getenv("PATH");
  setenv("PATH", directory.path().c_str(), 1);
  expect_refusal(directory, {image_of("EX9042D")}, {"install the package qemu-system-arm"});
  setenv("PATH", path.c_str(), 1);
}

}  // namespace
}  // namespace ex9000::system
