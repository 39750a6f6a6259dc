// Tests modules whose EEPROM is a file. The power fails, or the program is killed, at random times in line
// time. Each command that stores must take effect either completely or not at all. If the module has sent a
// valid reply to the command, the command must have taken effect completely (wire.md section 8). Line time is
// stepped, so the same seed always interrupts the same stores at the same moments.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdint>
#include <cstdio>
#include <functional>
#include <map>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/oracles/reference/hexadecimal.hpp"
#include "tests/sim/app/main/persistent_simulator.hpp"
#include "tests/support/directory.hpp"

namespace ex9000::system {
namespace {

/// The reply to each of the commands that read settings. Together, these commands read every setting that
/// class Stores changes.
using Answers = std::map<std::string, std::string>;

/// A command that stores, and the command that reads the stored value.
struct Store {
  std::string before;  ///< a command to send before `command`; empty if none is necessary
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
  /// Returns a command that stores the host watchdog's settings. An enabled watchdog has a timeout of 20 s or
  /// more, so that it does not expire during these tests.
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

/// The program in stepped time, with a master on its line.
class SteppedSimulator {
 public:
  explicit SteppedSimulator(const std::string& module)
      : process_({module, "--control", "control", "--timing", "instant", "--speed", "step"}),
        terminal_(process_.tty(), 9600),
        control_(process_.directory() + "/control") {}

  /// Sends a command to the control socket. See ControlClient::ok.
  std::string tell(const std::string& command) { return control_.ok(command); }
  /// Sends `command` and a CR on the line, and lets `time` pass. Returns the bytes that the module has sent.
  std::string ask_for(const std::string& time, const std::string& command) {
    terminal_.type(command + "\r");
    tell("advance " + time + " after " + std::to_string(command.size() + 1));
    return received();
  }
  /// Sends `command` and a CR on the line. Returns the reply without its CR.
  std::string ask(const std::string& command) {
    const std::string reply = ask_for("1s", command);
    return reply.substr(0, reply.find('\r'));
  }
  void power_off() { tell("1 power off"); }
  void power_on() {
    tell("1 power on");
    tell("advance 1s quiet");
  }
  void kill() { process_.end(SIGKILL); }

 private:
  std::string received() {
    const std::uint64_t sent = std::stoull(tell("sent"));
    std::string text;
    while (terminal_.received() < sent) {
      const std::vector<std::uint8_t> bytes = terminal_.read(kHang);
      if (bytes.empty()) {
        throw std::runtime_error("the simulator has sent " + std::to_string(sent) + " bytes; got fewer");
      }
      text.append(bytes.begin(), bytes.end());
    }
    return text;
  }

  SimulatorProcess process_;
  Terminal terminal_;
  ControlClient control_;
};

/// Sends commands that store, and checks the module's settings after each power failure or SIGKILL.
class PowerFailureChecker {
 public:
  explicit PowerFailureChecker(unsigned seed) : stores_(seed) {}

  [[nodiscard]] std::string module() const { return "EX9042D" + image_in(directory_); }

  /// Expects that the command that `begin_cut` sent last has taken effect either completely or not at all. If
  /// the test has received the reply to this command, the command must have taken effect completely. Call
  /// this function after each start of the module.
  void check(SteppedSimulator& simulator) {
    Answers answers;
    for (const auto& [question, answer] : before_) {
      answers[question] = simulator.ask(question);
    }
    EXPECT_TRUE(answers == after_ || (!acknowledged_ && answers == before_))
        << testing::PrintToString(answers) << "\nbefore: " << testing::PrintToString(before_)
        << "\nafter: " << testing::PrintToString(after_);
    // Until a store has succeeded, the LED may flash: an interrupted first write can leave a memory that is
    // not blank and contains no settings that the module can read (wire.md D8).
    EXPECT_TRUE(!anything_stored_ || simulator.tell("1 led") == "on");
    ++(acknowledged_ ? acknowledged_count_ : answers == after_ ? done_count_ : not_done_count_);
    half_written_count_ += !acknowledged_ && answers == before_ && answers != after_ && written_ ? 1 : 0;
    before_ = after_ = answers;
    acknowledged_ = true;
  }

  /// Sends up to two commands that store, and waits for the reply to each. Then sends another command that
  /// stores, lets a random time pass, mostly too little for the store and its reply, and calls `cut`.
  void cut(SteppedSimulator& simulator, const std::function<void()>& cut) {
    for (unsigned i = stores_.below(3); i > 0; --i) {
      const Store store = begin(simulator);
      EXPECT_EQ(simulator.ask(store.command), "!01") << store.command;
      before_ = after_;
      anything_stored_ = true;
    }
    const Store store = begin(simulator);
    const std::string image = bytes_of_file(directory_ / "image");
    constexpr unsigned kMostMicroseconds = 13'000;  // a store takes about 10 ms
    const std::string time = std::to_string(stores_.below(kMostMicroseconds)) + "us";
    acknowledged_ = simulator.ask_for(time, store.command) == "!01\r";
    cut();
    written_ = bytes_of_file(directory_ / "image") != image;
  }

  bool toss() { return stores_.below(2) == 0; }

  /// Expects that at least half of the cuts were before the reply, and that some of them were after the store
  /// and others before its end. If `may_tear`, a cut interrupts a write, so some must have changed the EEPROM
  /// although the module still uses the old settings. A kill does not: the file gets each write as a whole.
  void expect_hits(const char* what, bool may_tear) const {
    std::printf("%s: %d acknowledged, %d done but not acknowledged, %d not done, %d of these half written\n",
                what, acknowledged_count_, done_count_, not_done_count_, half_written_count_);
    EXPECT_GE(done_count_ + not_done_count_, acknowledged_count_);
    EXPECT_GT(done_count_, 0);
    EXPECT_GT(not_done_count_, 0);
    EXPECT_EQ(half_written_count_ > 0, may_tear);
  }

 private:
  Store begin(SteppedSimulator& simulator) {
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
  bool written_ = false;  ///< the last store has changed the image before the cut
  int acknowledged_count_ = 0;
  int done_count_ = 0;
  int not_done_count_ = 0;
  int half_written_count_ = 0;
};

TEST(Persistence, AKillNeverLeavesACommandHalfStoredOrLosesAnAcknowledgedCommand) {
  PowerFailureChecker checker(1);
  for (int round = 0; round < 60 && !HasFailure(); ++round) {
    SteppedSimulator simulator(checker.module());
    checker.check(simulator);
    checker.cut(simulator, [&] { simulator.kill(); });
  }
  SteppedSimulator simulator(checker.module());
  checker.check(simulator);
  checker.expect_hits("SIGKILL", false);
}

TEST(Persistence, APowerCutNeverLeavesACommandHalfStoredOrLosesAnAcknowledgedCommand) {
  PowerFailureChecker checker(2);
  SteppedSimulator simulator(checker.module());
  for (int round = 0; round < 40 && !HasFailure(); ++round) {
    checker.check(simulator);
    checker.cut(simulator, [&] { simulator.power_off(); });
    simulator.power_on();
  }
  checker.check(simulator);
  checker.expect_hits("power off", true);
}

TEST(Persistence, APowerCutBeforeAKillNeverLeavesACommandHalfStored) {
  PowerFailureChecker checker(3);
  for (int round = 0; round < 15 && !HasFailure(); ++round) {
    SteppedSimulator simulator(checker.module());
    checker.check(simulator);
    if (checker.toss()) {
      checker.cut(simulator, [&] { simulator.power_off(); });
      simulator.power_on();
      checker.check(simulator);
    }
    checker.cut(simulator, [&] { simulator.power_off(); });
    simulator.kill();
  }
  SteppedSimulator simulator(checker.module());
  checker.check(simulator);
  checker.expect_hits("power off and SIGKILL", true);
}

}  // namespace
}  // namespace ex9000::system
