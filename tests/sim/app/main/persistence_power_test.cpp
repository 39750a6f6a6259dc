// Tests modules whose EEPROM is a file. The power fails, or the program is killed, at random times. Each
// command that stores must take effect either completely or not at all. If the module has sent a valid
// reply to the command, the command must have taken effect completely (wire.md section 8).
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <csignal>
#include <cstdio>
#include <map>
#include <random>
#include <string>

#include "tests/oracles/reference/hexadecimal.hpp"
#include "tests/sim/app/main/persistent_simulator.hpp"
#include "tests/support/directory.hpp"

namespace ex9000::system {
namespace {

using std::chrono::microseconds;

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

/// Sends commands that store, and checks the module's settings after each power failure or SIGKILL.
class PowerFailureChecker {
 public:
  explicit PowerFailureChecker(unsigned seed) : stores_(seed) {}

  [[nodiscard]] std::string module() const { return "EX9042D" + image_in(directory_); }

  /// Expects that the command that `begin_cut` sent last has taken effect either completely or not at all. If
  /// the test has received the reply to this command, the command must have taken effect completely. Call
  /// this function after each start of the module.
  void check(Simulator& simulator) {
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
    before_ = after_ = answers;
    acknowledged_ = true;
  }

  /// Sends up to two commands that store, and waits for the reply to each. Then sends another command that
  /// stores. Waits for the reply to this command for a random time, which may be too short.
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
    std::printf("%s: %d acknowledged, %d done but not acknowledged, %d not done\n", what, acknowledged_count_,
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

TEST(Persistence, AKillNeverLeavesACommandHalfStoredOrLosesAnAcknowledgedCommand) {
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

TEST(Persistence, APowerCutNeverLeavesACommandHalfStoredOrLosesAnAcknowledgedCommand) {
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

TEST(Persistence, APowerCutBeforeAKillNeverLeavesACommandHalfStored) {
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

}  // namespace
}  // namespace ex9000::system
