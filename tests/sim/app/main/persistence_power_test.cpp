// Tests modules whose EEPROM is a file. The power fails, or the program is killed, at random times in line
// time. A command that stores must take effect either completely or not at all. If the module has sent a
// valid reply to the command, the command must have taken effect completely (wire.md section 8). Line time is
// stepped, so the same seed always interrupts the same stores at the same moments.
#include <gtest/gtest.h>

#include <csignal>
#include <cstdint>
#include <cstdio>
#include <random>
#include <stdexcept>
#include <string>
#include <vector>

#include "tests/sim/app/main/persistent_simulator.hpp"
#include "tests/support/directory.hpp"

namespace ex9000::system {
namespace {

/// The program in stepped time, with a master on its line.
class SteppedSimulator {
 public:
  explicit SteppedSimulator(const std::string& module)
      : process_({module, "--control", "control", "--timing", "instant", "--speed", "step"}),
        terminal_(process_.tty(), 9600),
        control_(process_.directory() + "/control") {}

  /// Sends `command` and a CR on the line, and lets `time` pass. Returns the bytes that the module has sent.
  std::string ask_for(const std::string& time, const std::string& command) {
    terminal_.type(command + "\r");
    control_.ok("advance " + time + " after " + std::to_string(command.size() + 1));
    return received();
  }
  /// Sends `command` and a CR on the line. Returns the reply without its CR.
  std::string ask(const std::string& command) {
    const std::string reply = ask_for("1s", command);
    return reply.substr(0, reply.find('\r'));
  }
  void power_off() { control_.ok("1 power off"); }
  void kill() { process_.end(SIGKILL); }

 private:
  std::string received() {
    const std::uint64_t sent = std::stoull(control_.ok("sent"));
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

class Persistence : public testing::TestWithParam<bool> {};

TEST_P(Persistence, AnInterruptedStoreIsCompleteOrHasNoEffectAndAnAcknowledgedOneIsComplete) {
  const bool power_fails = GetParam();
  const Directory directory;
  const std::string module = "EX9042D" + image_in(directory);
  std::mt19937 random(1);
  std::string stored = "!019042D";
  int acknowledged = 0;
  int done = 0;
  int not_done = 0;
  int torn = 0;
  for (int round = 10; round < 50 && !HasFailure(); ++round) {
    const std::string name = "NAME" + std::to_string(round);
    std::string image;
    bool replied = false;
    {
      SteppedSimulator simulator(module);
      image = bytes_of_file(directory / "image");
      constexpr unsigned kMostMicroseconds = 13'000;  // a store takes about 10 ms
      replied =
          simulator.ask_for(std::to_string(random() % kMostMicroseconds) + "us", "~01O" + name) == "!01\r";
      if (power_fails) {
        simulator.power_off();
      }
      simulator.kill();
    }
    const bool written = bytes_of_file(directory / "image") != image;
    const std::string found = SteppedSimulator(module).ask("$01M");
    const bool is_done = found == "!01" + name;
    EXPECT_TRUE(is_done || (!replied && found == stored)) << found << ", before: " << stored;
    ++(replied ? acknowledged : is_done ? done : not_done);
    torn += written && !is_done ? 1 : 0;
    stored = found;
  }
  std::printf("%d acknowledged, %d done but not acknowledged, %d not done, %d of these half written\n",
              acknowledged, done, not_done, torn);
  EXPECT_GE(done + not_done, acknowledged);
  EXPECT_GT(done, 0);
  EXPECT_GT(not_done, 0);
  // A power failure interrupts a write. If the program is killed, the file has each write as a whole.
  EXPECT_EQ(torn > 0, power_fails);
}

INSTANTIATE_TEST_SUITE_P(, Persistence, testing::Bool(),
                         [](const auto& kind) { return kind.param ? "PowerFails" : "Killed"; });

}  // namespace
}  // namespace ex9000::system
