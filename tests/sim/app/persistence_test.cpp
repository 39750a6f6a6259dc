// Modules whose EEPROM is a file: tests which settings survive each way in which the program can end.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <filesystem>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "tests/oracles/reference/hexadecimal.hpp"
#include "tests/support/control_client.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/simulator_process.hpp"
#include "tests/support/terminal.hpp"

namespace ex9000::system {
namespace {

namespace fs = std::filesystem;

using Arguments = std::vector<std::string>;
/// A timeout for events. Only a program that hangs reaches it.
constexpr std::chrono::seconds kHang{60};

using std::chrono::microseconds;

constexpr std::size_t kImageSize = 8192;
/// A timeout for replies. Only a program that hangs reaches it.
constexpr std::chrono::seconds kReplyTimeout{60};

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// The program with a control socket, and a master on its line.
class Simulator {
 public:
  explicit Simulator(const Arguments& modules)
      : process_(arguments(modules)),
        terminal_(process_.tty(), 9600),
        control_(process_.directory() + "/control") {}

  /// Sends a command and returns its reply, both without CR.
  std::string ask(const std::string& command) {
    type(command);
    const std::string reply = terminal_.read_line(kReplyTimeout);
    return reply.substr(0, reply.find('\r'));
  }
  std::string tell(const std::string& command) { return control_.ok(command); }

  /// Types a command. Returns whether a complete reply arrives within `time`.
  bool is_acknowledged_within(microseconds time, const std::string& command) {
    type(command);
    const std::vector<std::uint8_t> reply = terminal_.read(time);
    return !reply.empty() && reply.back() == '\r';
  }

  /// Switches the supply off. First waits until the typed commands are on the line, because a command on the
  /// control socket could overtake them.
  void power_off() {
    EXPECT_TRUE(process_.wait_for("  > master  ", typed_));
    tell("1 power off");
  }
  /// Switches the supply off and on again, and waits until the module has started.
  void power_cycle() {
    power_off();
    tell("1 power on");
    while (has(tell("1 status"), "mode=starting")) {
    }
    // Discards the replies that the module sent before.
    while (terminal_.received() < std::stoull(tell("sent")) && !terminal_.read(kHang).empty()) {
    }
  }

  SimulatorProcess& process() { return process_; }
  [[nodiscard]] const std::string& greeting() const { return process_.output(); }

 private:
  static Arguments arguments(Arguments words) {
    words.insert(words.end(), {"--control", "control", "--line", "instant", "--log"});
    return words;
  }

  void type(const std::string& command) {
    terminal_.type(command + "\r");
    ++typed_;
  }

  SimulatorProcess process_;
  Terminal terminal_;
  ControlClient control_;
  unsigned typed_ = 0;
};

std::string image_in(const Directory& directory) { return ",eeprom=" + directory / "image"; }

// --- the program creates a file, and uses an existing file ---

TEST(Persistence, AMissingFileIsCreatedFromThePresetsAndKeptAfterTheProgramEnds) {
  for (const int signal : {SIGKILL, SIGTERM}) {
    const Directory directory;
    std::string status;
    {
      Simulator first({"EX9042D-M@1A,protocol=ascii,checksum=on,name=PUMP" + image_in(directory)});
      EXPECT_TRUE(has(first.greeting(), directory / "image")) << first.greeting();
      EXPECT_EQ(bytes_of_file(directory / "image").size(), kImageSize);
      status = first.tell("1 status");
      EXPECT_TRUE(has(status, "address=1A")) << status;
      first.process().end(signal);
    }
    EXPECT_EQ(directory.contents().size(), 1U);
    Simulator second({"EX9042D-M" + image_in(directory)});
    EXPECT_EQ(second.tell("1 status"), status);
    EXPECT_TRUE(has(second.greeting(), "EX9042D-M at 1A, ASCII")) << second.greeting();
    EXPECT_EQ(second.ask("$1AME3"), "!1APUMPD5");
  }
}

TEST(Persistence, ANewFileWithoutPresetsHasFactorySettings) {
  const Directory directory;
  const std::string module = "EX9042D" + image_in(directory);
  for (int start = 0; start < 2; ++start) {
    Simulator simulator({module});
    EXPECT_EQ(simulator.ask("$01M"), "!019042D");
    EXPECT_EQ(simulator.ask("$012"), "!01400600");
    EXPECT_EQ(simulator.tell("1 led"), "on");
    EXPECT_EQ(bytes_of_file(directory / "image").size(), kImageSize);
  }
}

TEST(Persistence, TheFileOverridesThePresetsAndTheGreetingSaysSo) {
  const Directory directory;
  Simulator({"EX9042D@0A,name=FILED" + image_in(directory)});
  const std::string image = bytes_of_file(directory / "image");
  Simulator simulator({"EX9042D@0B,name=TYPED,edge=rising" + image_in(directory)});
  EXPECT_EQ(simulator.ask("$0AM"), "!0AFILED");
  EXPECT_EQ(simulator.ask("$0A2"), "!0A400600");
  EXPECT_TRUE(has(simulator.greeting(), "EX9042D at 0A")) << simulator.greeting();
  EXPECT_TRUE(has(simulator.greeting(), directory / "image" + ", not from the command line"))
      << simulator.greeting();
  EXPECT_EQ(bytes_of_file(directory / "image"), image);
}

TEST(Persistence, TheGreetingSaysThatTheFileOverridesTheBusFile) {
  const Directory directory;
  Simulator({"EX9042D@0A,name=FILED" + image_in(directory)});
  write_file(directory / "bus.json", R"({"lines": [{"tcp": 0, "modules": [
    {"model": "EX9042D", "address": "0B", "eeprom": "image"}]}]})");
  const Finished finished = run({simulator_path(), "bus.json", "--log", "--for", "100ms"}, directory.path());
  EXPECT_EQ(finished.status, 0) << finished.error;
  EXPECT_TRUE(has(finished.output, "settings from image, not from the bus file")) << finished.output;
}

TEST(Persistence, TheGreetingMentionsNoOverrideIfNoPresetDiffers) {
  const Directory directory;
  Simulator({"EX9042D@0A,name=FILED" + image_in(directory)});
  for (const char* module : {"EX9042D", "EX9042D@0A,name=FILED"}) {
    Simulator simulator({module + image_in(directory)});
    EXPECT_TRUE(has(simulator.greeting(), directory / "image")) << simulator.greeting();
    EXPECT_FALSE(has(simulator.greeting(), "not from the command line")) << simulator.greeting();
  }
}

TEST(Persistence, TheInitSwitchIsNotStored) {
  const Directory directory;
  Simulator({"EX9042D@0A,init=on" + image_in(directory)});
  Simulator simulator({"EX9042D" + image_in(directory)});
  EXPECT_TRUE(has(simulator.tell("1 status"), "address=0A")) << simulator.tell("1 status");
  EXPECT_TRUE(has(simulator.tell("1 status"), "mode=normal"));
}

TEST(Persistence, EveryModuleHasItsOwnFile) {
  const Directory directory;
  const std::string first = "EX9042D@01,eeprom=" + directory / "first";
  const std::string second = "EX9052D@02,eeprom=" + directory / "second";
  {
    Simulator simulator({first, second, "EX9060D@03"});
    EXPECT_EQ(simulator.ask("~01OONE"), "!01");
    EXPECT_EQ(simulator.ask("~02OTWO"), "!02");
    EXPECT_EQ(simulator.ask("~03OTHREE"), "!03");
    simulator.process().end(SIGKILL);
  }
  Simulator simulator({"EX9060D@03", second, first});
  EXPECT_EQ(simulator.ask("$01M"), "!01ONE");
  EXPECT_EQ(simulator.ask("$02M"), "!02TWO");
  EXPECT_EQ(simulator.ask("$03M"), "!039060");
}

TEST(Persistence, AFileMayBeReachedThroughASymbolicLink) {
  const Directory directory;
  Simulator({"EX9042D" + image_in(directory)});
  fs::create_symlink("image", directory / "link");
  {
    Simulator simulator({"EX9042D,eeprom=" + directory / "link"});
    EXPECT_EQ(simulator.ask("~01ONEW"), "!01");
  }
  EXPECT_TRUE(fs::is_symlink(directory / "link"));
  EXPECT_EQ(Simulator({"EX9042D" + image_in(directory)}).ask("$01M"), "!01NEW");
}

TEST(Persistence, OutputsStartWithTheStoredPowerOnValue) {
  const Directory directory;
  {
    Simulator simulator({"EX9042D" + image_in(directory)});
    EXPECT_EQ(simulator.ask("@011A05"), ">");
    EXPECT_EQ(simulator.ask("~015P"), "!01");
    EXPECT_EQ(simulator.ask("@010000"), ">");
    simulator.process().end(SIGKILL);
  }
  EXPECT_EQ(Simulator({"EX9042D" + image_in(directory)}).tell("1 outputs"), "1A05");
}

TEST(Persistence, AHostWatchdogTimeoutSurvivesARestart) {
  const Directory directory;
  {
    Simulator simulator({"EX9042D" + image_in(directory)});
    EXPECT_EQ(simulator.ask("@011001"), ">");
    EXPECT_EQ(simulator.ask("~015S"), "!01");
    EXPECT_EQ(simulator.ask("~013101"), "!01");
    // Polls instead of waiting for text in the log: this test does not read the log meanwhile, and a full
    // pipe would stop the program.
    while (simulator.tell("1 led") != "flashing") {
    }
    EXPECT_EQ(simulator.ask("~010"), "!0184");
    EXPECT_EQ(simulator.ask("~01ONEW"), "!01");  // the module has stored the timeout before it replies
    simulator.process().end(SIGKILL);
  }
  Simulator simulator({"EX9042D" + image_in(directory)});
  EXPECT_EQ(simulator.ask("~010"), "!0184");
  EXPECT_EQ(simulator.tell("1 led"), "flashing");
  EXPECT_EQ(simulator.tell("1 outputs"), "1001");
}

// --- images without valid settings (wire.md D8) ---

/// Expects factory settings, a flashing LED and a remark in the greeting. The file must not change until the
/// module stores something.
void expect_factory_settings(const Directory& directory) {
  const std::string image = bytes_of_file(directory / "image");
  {
    Simulator simulator({"EX9042D@0B,name=TYPED" + image_in(directory)});
    EXPECT_EQ(simulator.ask("$01M"), "!019042D");
    EXPECT_EQ(simulator.ask("$012"), "!01400600");
    EXPECT_EQ(simulator.tell("1 outputs"), "0000");
    EXPECT_EQ(simulator.tell("1 led"), "flashing");
    EXPECT_TRUE(has(simulator.greeting(), directory / "image")) << simulator.greeting();
    EXPECT_TRUE(has(simulator.greeting(), "factory settings")) << simulator.greeting();
    simulator.process().end(SIGKILL);
    EXPECT_EQ(bytes_of_file(directory / "image"), image);
  }
  {
    Simulator simulator({"EX9042D" + image_in(directory)});
    EXPECT_EQ(simulator.ask("~01ONEW"), "!01");
    EXPECT_EQ(simulator.tell("1 led"), "on");
    simulator.process().end(SIGKILL);
  }
  Simulator simulator({"EX9042D" + image_in(directory)});
  EXPECT_EQ(simulator.ask("$01M"), "!01NEW");
  EXPECT_EQ(simulator.tell("1 led"), "on");
  EXPECT_FALSE(has(simulator.greeting(), "factory settings")) << simulator.greeting();
}

TEST(Persistence, AnImageOfAnotherModelGivesFactorySettings) {
  const Directory directory;
  {
    Simulator other({"EX9043D" + image_in(directory)});
    EXPECT_EQ(other.ask("@01FFFF"), ">");
    EXPECT_EQ(other.ask("~015P"), "!01");
    EXPECT_EQ(other.ask("~01OOTHER"), "!01");
  }
  expect_factory_settings(directory);
}

TEST(Persistence, AnImageOfGarbageGivesFactorySettings) {
  std::mt19937 random(9042);
  std::string noise(kImageSize, '\0');
  std::generate(noise.begin(), noise.end(), [&random] { return static_cast<char>(random() & 0xFFU); });
  for (const std::string& image : {noise, std::string(kImageSize, '\0')}) {
    const Directory directory;
    write_file(directory / "image", image);
    expect_factory_settings(directory);
  }
}

TEST(Persistence, ABlankImageGivesFactorySettingsDespitePresets) {
  const Directory directory;
  write_file(directory / "image", std::string(kImageSize, '\xFF'));
  Simulator simulator({"EX9042D@0B,name=TYPED" + image_in(directory)});
  EXPECT_EQ(simulator.ask("$01M"), "!019042D");
  EXPECT_EQ(simulator.tell("1 led"), "on");
  EXPECT_TRUE(has(simulator.greeting(), "not from the command line")) << simulator.greeting();
}

// --- wire.md 8: a reply means that the settings are stored; the power may fail at any time ---

/// Commands that read everything that the stores below change, and their replies.
using Answers = std::map<std::string, std::string>;

/// A command that stores, and the command that reads the stored value.
struct Store {
  std::string before;  ///< the command to send first; empty: none
  std::string command;
  std::string question;
  std::string answer;
};

class Stores {
 public:
  explicit Stores(unsigned seed) : random_(seed) {}

  unsigned below(unsigned limit) { return static_cast<unsigned>(random_() % limit); }

  Store any() {
    switch (below(5)) {
      case 0:
        return name();
      case 1:
        return host_watchdog();
      case 2:
        return outputs('P');
      case 3:
        return outputs('S');
      default: {
        const std::string format = below(2) == 0 ? "00" : "80";
        return {"", "%01014006" + format, "$012", "!014006" + format};
      }
    }
  }

 private:
  Store name() {
    std::string name(1 + below(6), ' ');
    std::generate(name.begin(), name.end(), [this] { return static_cast<char>(0x20U + below(0x5F)); });
    return {"", "~01O" + name, "$01M", "!01" + name};
  }
  /// Returns a store of the host watchdog's settings. An enabled watchdog has a timeout of 20 s or more, so
  /// that it never expires in these tests.
  Store host_watchdog() {
    const bool on = below(2) == 0;
    const std::string value = (on ? "1" : "0") + reference::hex(on ? 200 + below(56) : 1 + below(255), 2);
    return {"", "~013" + value, "~012", "!01" + value};
  }
  Store outputs(char kind) {
    const std::string value = reference::hex(below(0x2000), 4);
    return {"@01" + value, std::string("~015") + kind, std::string("~014") + kind, "!01" + value};
  }

  std::mt19937 random_;
};

/// Checks which settings a module has after each of many power failures.
class PowerFailureChecker {
 public:
  explicit PowerFailureChecker(unsigned seed) : stores_(seed) {}

  [[nodiscard]] std::string module() const { return "EX9042D" + image_in(directory_); }

  /// Call this after a start. The last command must be carried out completely or not at all, and completely
  /// if it was acknowledged.
  void check(Simulator& simulator) {
    Answers answers;
    for (const auto& [question, answer] : before_) {
      answers[question] = simulator.ask(question);
    }
    EXPECT_TRUE(answers == after_ || (!acknowledged_ && answers == before_))
        << testing::PrintToString(answers) << "\nbefore: " << testing::PrintToString(before_)
        << "\nafter: " << testing::PrintToString(after_);
    // If the first write to a blank memory was interrupted, the memory is neither blank nor readable (wire.md
    // D8).
    EXPECT_TRUE(!anything_stored_ || simulator.tell("1 led") == "on");
    ++(acknowledged_ ? acknowledged_count_ : answers == after_ ? done_count_ : not_done_count_);
    before_ = after_ = answers;
    acknowledged_ = true;
  }

  /// Sends up to two stores and waits for their acknowledgements. Then sends another store, which may not be
  /// acknowledged in time.
  void begin_cut(Simulator& simulator) {
    for (unsigned i = stores_.below(3); i > 0; --i) {
      const Store store = begin(simulator);
      EXPECT_EQ(simulator.ask(store.command), "!01") << store.command;
      before_ = after_;
      anything_stored_ = true;
    }
    const Store store = begin(simulator);
    constexpr unsigned kMostMicroseconds = 13'000;  // a store takes about 10 ms
    acknowledged_ =
        simulator.is_acknowledged_within(microseconds(stores_.below(kMostMicroseconds)), store.command);
  }

  bool toss() { return stores_.below(2) == 0; }

  void report(const char* what) const {
    std::printf("%s: %d acknowledged, %d done before the reply, %d not done\n", what, acknowledged_count_,
                done_count_, not_done_count_);
  }

 private:
  Store begin(Simulator& simulator) {
    const Store store = stores_.any();
    if (!store.before.empty()) {
      EXPECT_EQ(simulator.ask(store.before), ">") << store.before;
    }
    after_[store.question] = store.answer;
    return store;
  }

  Directory directory_;
  Stores stores_;
  Answers before_{{"$012", "!01400600"},
                  {"$01M", "!019042D"},
                  {"~012", "!010FF"},
                  {"~014P", "!010000"},
                  {"~014S", "!010000"}};
  Answers after_ = before_;
  bool acknowledged_ = true;
  bool anything_stored_ = false;
  int acknowledged_count_ = 0;
  int done_count_ = 0;
  int not_done_count_ = 0;
};

TEST(Persistence, AKillAtAnyTimeLeavesStoresAtomicAndKeepsAcknowledgedOnes) {
  PowerFailureChecker checker(1);
  for (int round = 0; round < 60 && !HasFailure(); ++round) {
    Simulator simulator({checker.module()});
    checker.check(simulator);
    checker.begin_cut(simulator);
    simulator.process().end(SIGKILL);
  }
  Simulator simulator({checker.module()});
  checker.check(simulator);
  checker.report("SIGKILL");
}

TEST(Persistence, APowerCutAtAnyTimeLeavesStoresAtomicAndKeepsAcknowledgedOnes) {
  PowerFailureChecker checker(2);
  Simulator simulator({checker.module()});
  for (int round = 0; round < 40 && !HasFailure(); ++round) {
    checker.check(simulator);
    checker.begin_cut(simulator);
    simulator.power_cycle();
  }
  checker.check(simulator);
  checker.report("power off");
}

TEST(Persistence, APowerCutFollowedByAKillLeavesStoresAtomic) {
  PowerFailureChecker checker(3);
  for (int round = 0; round < 15 && !HasFailure(); ++round) {
    Simulator simulator({checker.module()});
    checker.check(simulator);
    if (checker.toss()) {
      checker.begin_cut(simulator);
      simulator.power_cycle();
      checker.check(simulator);
    }
    checker.begin_cut(simulator);
    simulator.power_off();
    simulator.process().end(SIGKILL);
  }
  Simulator simulator({checker.module()});
  checker.check(simulator);
  checker.report("power off and SIGKILL");
}

// --- files that the program rejects ---

/// Expects that the program does not start: exit status 2, one line that names the file, and no change in
/// `directory`.
void expect_refused(const Arguments& modules, const std::string& file, const Directory& directory) {
  const auto before = directory.contents();
  Arguments command{"timeout", "60", simulator_path(), "--control", "control"};
  command.insert(command.end(), modules.begin(), modules.end());
  const Finished finished = run(command, directory.path());
  EXPECT_EQ(finished.status, 2) << finished.error;
  EXPECT_EQ(finished.output, "");
  EXPECT_TRUE(has(finished.error, "eeprom=" + file + ": ")) << finished.error;
  EXPECT_EQ(std::count(finished.error.begin(), finished.error.end(), '\n'), 1) << finished.error;
  EXPECT_EQ(directory.contents(), before) << finished.error;
}

/// Tests the file alone, and after another module whose file would be created too.
void expect_refused(const std::string& file, const Directory& directory) {
  expect_refused({"EX9042D,name=NEW,eeprom=" + file}, file, directory);
  expect_refused({"EX9052D@02,eeprom=beside", "EX9042D,eeprom=" + file}, file, directory);
}

std::string some_image() { return std::string(kImageSize, '\xFF'); }

TEST(BadFile, AFileOfTheWrongSizeIsRefused) {
  for (const std::size_t size : {0U, 100U, 8191U, 8193U}) {
    const Directory directory;
    write_file(directory / "image", std::string(size, 'x'));
    expect_refused("image", directory);
  }
}

TEST(BadFile, AReadOnlyFileIsRefusedForEveryUser) {
  const Directory directory;
  write_file(directory / "image", some_image());
  fs::permissions(directory / "image", fs::perms(0444));
  expect_refused("image", directory);
}

TEST(BadFile, DirectoriesPipesAndDevicesAreRefusedWithoutBlocking) {
  const Directory directory;
  fs::create_directory(directory / "image");
  ASSERT_EQ(mkfifo((directory / "fifo").c_str(), 0644), 0);
  for (const char* file : {"image", "fifo", "/dev/null", "/dev/full"}) {
    expect_refused(file, directory);
  }
}

TEST(BadFile, AFileThatCannotBeCreatedIsRefusedAndNoOtherIsCreated) {
  const Directory directory;
  fs::create_symlink("missing/image", directory / "dangling");
  for (const char* file : {"missing/image", "dangling", "/proc/image"}) {
    expect_refused(file, directory);
  }
}

TEST(BadFile, AFileInUseByAnotherProcessIsRefusedUnderAnyName) {
  const Directory directory;
  write_file(directory / "image", some_image());
  fs::create_symlink("image", directory / "symbolic");
  fs::create_hard_link(directory / "image", directory / "hard");
  Simulator simulator({"EX9042D" + image_in(directory)});
  for (const char* file : {"image", "symbolic", "hard", "./image"}) {
    expect_refused(file, directory);
  }
  EXPECT_EQ(simulator.ask("~01ONEW"), "!01");
  simulator.process().end(SIGKILL);
  EXPECT_EQ(Simulator({"EX9042D" + image_in(directory)}).ask("$01M"), "!01NEW");
}

TEST(BadFile, TwoNamesOfOneFileForTwoModulesAreRefused) {
  const Directory directory;
  write_file(directory / "image", some_image());
  fs::create_symlink("image", directory / "symbolic");
  fs::create_hard_link(directory / "image", directory / "hard");
  for (const char* file : {"image", "symbolic", "hard", "./image"}) {
    expect_refused({"EX9042D,eeprom=image", std::string("EX9052D@02,eeprom=") + file}, file, directory);
  }
}

TEST(BadFile, TwoNamesOfOneMissingFileAreRefusedAndNoFileIsCreated) {
  const Directory directory;
  fs::create_directory(directory / "place");
  fs::create_directory_symlink("place", directory / "elsewhere");
  expect_refused({"EX9042D,eeprom=image", "EX9052D@02,eeprom=./image"}, "./image", directory);
  expect_refused({"EX9042D,eeprom=place/image", "EX9052D@02,eeprom=elsewhere/image"}, "elsewhere/image",
                 directory);
  const Finished finished =
      run({simulator_path(), "EX9042D,eeprom=image", "EX9052D@02,eeprom=./image"}, directory.path());
  EXPECT_TRUE(has(finished.error, "eeprom=./image: two modules cannot share a file")) << finished.error;
}

TEST(BadFile, NoFileIsCreatedIfAnotherArgumentIsRefused) {
  const Directory directory;
  write_file(directory / "taken", "precious");
  const auto before = directory.contents();
  for (const Arguments& wrong :
       {Arguments{"--control", "taken"}, Arguments{"--pty", "taken"}, Arguments{"--pty", "missing/tty"},
        Arguments{"--tcp", "256.0.0.1:5020"}, Arguments{"--serial", "missing"}}) {
    Arguments command{"timeout", "60", simulator_path(), "EX9042D,eeprom=image"};
    command.insert(command.end(), wrong.begin(), wrong.end());
    EXPECT_EQ(run(command, directory.path()).status, 2) << wrong[0];
    EXPECT_EQ(directory.contents(), before) << wrong[0];
  }
}

}  // namespace
}  // namespace ex9000::system
