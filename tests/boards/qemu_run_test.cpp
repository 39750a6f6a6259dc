// boards/lm3s6965evb/run, as a user would start it: the shipped image on a pseudo-terminal.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <modbus/modbus.h>
#include <poll.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <string>
#include <thread>
#include <vector>

#include "firmware/hex.hpp"
#include "tests/support/child_process.hpp"
#include "tests/support/directory.hpp"
#include "tests/masters/libmodbus_master.hpp"
#include "tests/support/socket_client.hpp"
#include "tests/support/terminal.hpp"

namespace ex9000::system {
namespace {

namespace fs = std::filesystem;
using Arguments = std::vector<std::string>;

const std::string kRun = EX9000_RUN;
constexpr std::size_t kEepromSize = 8192;
constexpr int kRepetitions = 10;

std::string image_of(const std::string& model) { return EX9000_IMAGES "/" + model + ".elf"; }
bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The image of a model, running.
class RunningImage {
 public:
  explicit RunningImage(const std::string& model, const Arguments& options = {})
      : process_(words(model, options), directory_.path()) {
    if (!process_.wait_for("Ctrl-C ends it")) {
      throw std::runtime_error(model + " does not run");
    }
  }

  /// What it prints first.
  [[nodiscard]] std::string tty() const { return process_.output().substr(0, process_.output().find('\n')); }
  ChildProcess& process() { return process_; }
  [[nodiscard]] int qemu() const {
    const std::string pid = std::to_string(process_.pid());
    std::ifstream children("/proc/" + pid + "/task/" + pid + "/children");
    int child = -1;
    children >> child;
    return child;
  }

  /// Types a command, its CR included, and reads the answer up to CR.
  [[nodiscard]] std::string ask(const std::string& command) const {
    Terminal terminal(tty(), 9600);
    terminal.type(command + "\r");
    const std::string reply = terminal.read_line();
    return reply.substr(0, reply.find('\r'));
  }

  /// A busy host may hold a frame up for longer than T3.5, which ends it; then a master repeats.
  [[nodiscard]] Finished mbpoll(Arguments options, const Arguments& values = {}) const {
    options.insert(options.begin(), {"mbpoll", "-m", "rtu", "-b", "9600", "-P", "none", "-1"});
    options.push_back(tty());
    options.insert(options.end(), values.begin(), values.end());
    Finished finished = system::run(options);
    for (int i = 0; i < kRepetitions && has(finished.error, "timed out"); ++i) {
      finished = system::run(options);
    }
    return finished;
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

/// It is gone, or nothing but an entry that its parent has not looked at.
bool has_ended(int pid) {
  std::ifstream status("/proc/" + std::to_string(pid) + "/stat");
  std::string number;
  std::string name;
  std::string state;
  status >> number >> name >> state;
  return !status || state == "Z";
}

bool ends(int pid) {
  for (int i = 0; i < 1000 && !has_ended(pid); ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return has_ended(pid);
}

// --- masters ---

TEST(QemuRun, MbpollReadsAndWrites) {
  const RunningImage image("EX9042D-M");
  EXPECT_TRUE(has(image.mbpoll({"-a", "1", "-t", "0", "-r", "3"}, {"1"}).output, "Written 1 references."));
  EXPECT_TRUE(has(image.mbpoll({"-a", "1", "-t", "0", "-r", "1", "-c", "13"}).output,
                  "[1]: \t0\n[2]: \t0\n[3]: \t1\n[4]: \t0\n[5]: \t0\n[6]: \t0\n[7]: \t0\n[8]: \t0\n"
                  "[9]: \t0\n[10]: \t0\n[11]: \t0\n[12]: \t0\n[13]: \t0\n"));
}

/// See RunningImage::mbpoll.
template <typename Call>
int repeated(Call call) {
  int result = call();
  for (int i = 0; i < kRepetitions && result == -1 && errno == ETIMEDOUT; ++i) {
    result = call();
  }
  return result;
}

TEST(QemuRun, LibmodbusReadsAndWrites) {
  const RunningImage image("EX9042D-M");
  LibmodbusMaster master(image.tty(), 9600);
  modbus_t* const module = master.at(1);
  const std::array<std::uint8_t, 13> written{1, 0, 1, 1, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  std::array<std::uint8_t, 13> read{};
  ASSERT_EQ(repeated([&] { return modbus_write_bits(module, 0, 13, written.data()); }), 13);
  ASSERT_EQ(repeated([&] { return modbus_read_bits(module, 0, 13, read.data()); }), 13);
  EXPECT_EQ(read, written);
  EXPECT_EQ(repeated([&] { return modbus_write_bit(module, 13, 1); }), -1);
  EXPECT_EQ(errno, EMBXILADD);
}

TEST(QemuRun, APersonMayType) {
  const RunningImage image("EX9042D");
  Terminal terminal(image.tty(), 9600);
  for (const char key : std::string("$01M\r")) {
    terminal.type({key});
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  EXPECT_EQ(terminal.read_line(), "!019042D\r");
}

TEST(QemuRun, MastersComeAndGo) {
  const RunningImage image("EX9042D");
  for (int visit = 0; visit < 20; ++visit) {
    EXPECT_EQ(image.ask("$01M"), "!019042D");
  }
}

TEST(QemuRun, ARequestOfAMasterThatHasGoneIsDone) {
  const RunningImage image("EX9042D");
  Terminal(image.tty(), 9600).type("@010005\r");
  std::string outputs = image.ask("@01");
  for (int i = 0; i < 100 && outputs != ">0005"; ++i) {
    outputs = image.ask("@01");
  }
  EXPECT_EQ(outputs, ">0005");
}

/// Waits until there is something to read, and leaves it there.
void wait_for_something_on(const std::string& tty) {
  const int fd = open(tty.c_str(), O_RDWR | O_NOCTTY | O_CLOEXEC);
  pollfd ready{fd, POLLIN, 0};
  EXPECT_EQ(poll(&ready, 1, 10'000), 1);
  close(fd);
}

TEST(QemuRun, WhatOneMasterLeavesUnreadIsNotTheNextOnesFirst) {
  const RunningImage image("EX9042D");
  for (int visit = 0; visit < 5; ++visit) {
    {
      Terminal terminal(image.tty(), 9600);
      terminal.type("$01M\r");
      wait_for_something_on(image.tty());
      std::this_thread::sleep_for(std::chrono::milliseconds(100));  // all of it
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(100));
    EXPECT_EQ(image.ask("$012"), "!01400600");
  }
}

TEST(QemuRun, AMasterThatNeverReadsDoesNotStopTheModule) {
  const RunningImage image("EX9042D");
  {
    Terminal terminal(image.tty(), 9600);
    for (int request = 0; request < 1000; ++request) {  // their answers are twice what a terminal holds
      terminal.type("$01M\r");
      std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
  }
  Terminal terminal(image.tty(), 9600);
  while (!terminal.read(std::chrono::seconds(1)).empty()) {  // answers to what was still under way
  }
  terminal.type("$012\r");
  EXPECT_EQ(terminal.read_line(), "!01400600\r");
}

// --- what lasts ---

TEST(QemuRun, SettingsAreFoundAgainInTheEepromFile) {
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

TEST(QemuRun, WithoutAFileEveryRunIsAFactoryFreshModule) {
  EXPECT_EQ(RunningImage("EX9042D").ask("~01OPUMP"), "!01");
  EXPECT_EQ(RunningImage("EX9042D").ask("$01M"), "!019042D");
}

// --- resets ---

/// A debugger, which stops the processor for as long as it is there.
class Debugger {
 public:
  explicit Debugger(std::uint16_t port) : client_(port) {
    ask("qXfer:features:read:target.xml:0,fff");  // or QEMU does not let registers be written one by one
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

  /// GDB's remote protocol: a command and its reply, without what surrounds them.
  std::string ask(const std::string& command) {
    unsigned sum = 0;
    for (const char character : command) {
      sum += static_cast<unsigned char>(character);
    }
    client_.send("$" + command + "#" + hex_of(sum & 0xFFU).substr(6));
    std::string reply = packet();
    while (!reply.empty() && reply[0] == 'T') {  // that it has stopped
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

/// What is said to a module that hangs is lost; how long its watchdog takes by the clock on the wall is for
/// the host to say, which runs the loop that it hangs in.
bool answers_again(const RunningImage& image) {
  constexpr std::chrono::seconds kPatience{1};
  constexpr int kTries = 60;
  Terminal terminal(image.tty(), 9600);
  bool answered = false;
  for (int i = 0; i < kTries && !answered; ++i) {
    terminal.type("$01M\r");
    answered = terminal.read_line(kPatience) == "!019042D\r";
  }
  while (!terminal.read(kPatience).empty()) {  // answers to the tries before
  }
  return answered;
}

/// With INIT* low it would come up in INIT mode and not answer to 01 any more.
TEST(QemuRun, InitStaysReleasedThroughAResetOfTheModulesOwn) {
  constexpr std::uint32_t kNothingThere = 0xF0000000;
  constexpr std::uint32_t kDeafLoop = 0x20008000;
  constexpr std::uint32_t kLoop = kDeafLoop + 2;
  const std::string port = std::to_string(20000 + getpid() % 10000);
  const RunningImage image("EX9042D", {"--gdb", port});
  EXPECT_EQ(image.ask("$015"), "!011");
  for (const std::uint32_t address : {kNothingThere, kLoop, kDeafLoop}) {  // a fault; the watchdog's
    EXPECT_EQ(image.ask("$015"), "!010");
    EXPECT_EQ(image.ask("@010005"), ">");
    Debugger debugger(static_cast<std::uint16_t>(std::stoi(port)));
    debugger.write_memory(kDeafLoop, "72b6fee7");  // `cpsid i`, `b .`, where neither data nor stack reach
    debugger.send_processor_to(address);
    debugger.leave();
    ASSERT_TRUE(answers_again(image)) << address;
    EXPECT_EQ(image.ask("$015"), "!011");
    EXPECT_EQ(image.ask("@01"), ">0000");
  }
}

// --- its end ---

TEST(QemuRun, EndsCleanlyAndTakesQemuAlong) {
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

TEST(QemuRun, LeavesNoQemuBehindWhenItIsKilled) {
  const Directory directory;
  const Arguments options{"--link", directory / "tty"};
  {
    RunningImage image("EX9042D", options);
    const int qemu = image.qemu();
    image.process().end(SIGKILL);
    EXPECT_TRUE(ends(qemu));
  }
  const RunningImage next("EX9042D", options);  // which takes the link over
  EXPECT_EQ(fs::read_symlink(directory / "tty"), next.tty());
}

TEST(QemuRun, EndsWhenQemuDoes) {
  const Directory directory;
  RunningImage image("EX9042D", {"--link", directory / "tty"});
  kill(image.qemu(), SIGKILL);
  EXPECT_EQ(image.process().wait(), 1);
  EXPECT_TRUE(directory.contents().empty());
}

// --- what it refuses ---

/// One line that holds `words`, and nothing left behind in `directory`.
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

TEST(QemuRun, RefusesWhatIsNoImageForThisBoard) {
  const Directory directory;
  expect_refusal(directory, {"none.elf"}, {"none.elf: No such file", "cmake --build --preset lm3s6965evb"});
  expect_refusal(directory, {"/"}, {"/: Is a directory"});
  write_file(directory / "text.elf", "no image");
  expect_refusal(directory, {"text.elf"}, {"text.elf: no ELF file for Arm"});
  expect_refusal(directory, {"/usr/bin/python3"}, {"/usr/bin/python3: no ELF file for Arm"});
  expect_refusal(directory, {EX9000_IMAGES "/EX9042D.bin"}, {"EX9042D.bin: no ELF file", "MODEL.elf"});

  std::string image = bytes_of_file(image_of("EX9042D"));
  const std::string top_of_ram("\x00\x00\x01\x20", 4);
  const std::string top_of_the_launchpads("\x00\x80\x00\x20", 4);
  image.replace(image.find(top_of_ram), top_of_ram.size(), top_of_the_launchpads);
  write_file(directory / "other.elf", image);
  expect_refusal(directory, {"other.elf"}, {"other.elf: made for another board", "lm3s6965evb"});
}

TEST(QemuRun, RefusesAnEepromFileThatItCannotUse) {
  const Directory directory;
  const std::string image = image_of("EX9042D");
  write_file(directory / "short", std::string(kEepromSize - 1, '\xFF'));
  expect_refusal(directory, {image, "--eeprom", "short"}, {"--eeprom short: 8191 bytes", "8192", "remove"});
  expect_refusal(directory, {image, "--eeprom", "/"}, {"--eeprom /: Is a directory", "name a file"});
  expect_refusal(directory, {image, "--eeprom", "none/eeprom"}, {"--eeprom none/eeprom: No such file"});
  const RunningImage other("EX9042D", {"--eeprom", directory / "taken"});
  expect_refusal(directory, {image, "--eeprom", "taken"}, {"--eeprom taken: another run has it"});
}

TEST(QemuRun, RefusesALinkWhereSomethingIs) {
  const Directory directory;
  const std::string image = image_of("EX9042D");
  write_file(directory / "file", "somebody's");
  fs::create_symlink("file", directory / "link");
  for (const std::string path : {"file", "link", "/"}) {
    expect_refusal(directory, {image, "--link", path}, {"--link " + path + ": something is there", "remove"});
  }
  expect_refusal(directory, {image, "--link", "none/tty"}, {"--link none/tty: No such file"});
  const RunningImage other("EX9042D", {"--link", directory / "taken"});
  expect_refusal(directory, {image, "--link", "taken"}, {"--link taken: something is there"});
}

TEST(QemuRun, SaysWhatQemuCouldNotDo) {
  const Directory directory;
  const std::string port = std::to_string(20000 + getpid() % 10000);
  const RunningImage other("EX9042D", {"--gdb", port});
  expect_refusal(directory, {image_of("EX9042D"), "--gdb", port}, {"qemu-system-arm has ended", "in use"}, 1);
}

TEST(QemuRun, NamesThePackageThatIsMissing) {
  const Directory directory;
  const std::string path = getenv("PATH");
  setenv("PATH", directory.path().c_str(), 1);
  expect_refusal(directory, {image_of("EX9042D")}, {"install the package qemu-system-arm"});
  setenv("PATH", path.c_str(), 1);
}

}  // namespace
}  // namespace ex9000::system
