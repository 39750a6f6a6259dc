// The rigs of `ex9000 verify`: a program, and a person.
#include <gtest/gtest.h>

#include <csignal>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "sim/utility/verify/command_rig.hpp"
#include "sim/utility/verify/person_rig.hpp"
#include "tests/support/directory.hpp"

namespace ex9000::utility {
namespace {

/// What `ask` throws, or what it returns.
std::string answer_of(Rig& rig, const std::string& request) {
  try {
    return rig.ask(request);
  } catch (const NotVerified& error) {
    return std::string("not verified: ") + error.what();
  } catch (const std::exception& error) {
    return error.what();
  }
}

class CommandRigs : public testing::Test {
 protected:
  CommandRigs() { static_cast<void>(std::signal(SIGPIPE, SIG_IGN)); }  // as main.cpp
};

TEST_F(CommandRigs, AnswerRequestsLineByLine) {
  CommandRig rig(R"(
    relays=
    while read -r what channel rest; do
      case $what in
        power|init) relays="$relays $what:$channel"; echo ok ;;
        outputs) echo ok 0A05 ;;
        led) echo "ok$relays" ;;
        reset) echo error: the relay does not answer ;;
        pulse) echo fine ;;
        input) echo cannot ;;
      esac
    done)");
  EXPECT_EQ(answer_of(rig, "power on"), "");
  EXPECT_EQ(answer_of(rig, "init off"), "");
  EXPECT_EQ(answer_of(rig, "outputs"), "0A05");
  EXPECT_EQ(answer_of(rig, "input 3 on"), "not verified: the rig cannot do 'input 3 on'");
  EXPECT_NE(answer_of(rig, "led").find("power:on init:off"), std::string::npos);
}

TEST_F(CommandRigs, ThatAreBrokenAreReported) {
  const std::pair<const char*, const char*> kRows[] = {
      {"exit 1", "--rig: 'exit 1' has ended; it must answer until its input ends"},
      {"read -r line; exit 0",
       "--rig: 'read -r line; exit 0' has ended; it must answer until its input ends"},
      {"echo yes; cat",
       "--rig: 'echo yes; cat' answers 'power on' with 'yes'; expected ok, ok VALUE, cannot or "
       "error: TEXT"},
      {"echo okay; cat",
       "--rig: 'echo okay; cat' answers 'power on' with 'okay'; expected ok, ok VALUE, cannot "
       "or error: TEXT"},
      {"echo error: no USB; cat", "--rig: 'echo error: no USB; cat' reports to 'power on': error: no USB"},
      {"./no-such-rig 2>&-", "--rig: './no-such-rig 2>&-' has ended; it must answer until its input ends"},
  };
  for (const auto& [command, problem] : kRows) {
    CommandRig rig(command);
    EXPECT_EQ(answer_of(rig, "power on"), problem);
  }
}

TEST_F(CommandRigs, ThatAnswerTwiceAreReported) {
  CommandRig rig(R"(while read -r line; do printf 'ok\nok\n'; done)");
  EXPECT_EQ(answer_of(rig, "power on"), "");
  EXPECT_NE(answer_of(rig, "outputs").find("has answered more than it was asked"), std::string::npos);
}

TEST_F(CommandRigs, EndWhenTheirInputEnds) {
  const system::Directory directory;
  { CommandRig rig("cat >" + (directory / "requests") + "; echo off >" + (directory / "end")); }
  EXPECT_TRUE(std::ifstream(directory / "end").good());
}

TEST(PersonRigs, AskForWhatToDo) {
  std::vector<std::string> answers;
  std::vector<std::string> questions;
  PersonRig rig([&](const std::string& question) -> std::optional<std::string> {
    questions.push_back(question);
    if (answers.empty()) {
      return std::nullopt;
    }
    const std::string answer = answers.front();
    answers.erase(answers.begin());
    return answer;
  });
  struct Row {
    const char* request;
    std::vector<std::string> answers;
    const char* result;
  };
  const Row kRows[] = {
      {"power off", {""}, ""},
      {"init on", {"what?", ""}, ""},
      {"input 3 on", {"s"}, "not verified: nobody could do 'input 3 on'"},
      {"outputs", {"0 3 12"}, "1009"},
      {"outputs", {"16", "x", ""}, "0000"},
      {"led", {"yes", "flashing"}, "flashing"},
      {"led", {"s"}, "not verified: nobody could do 'led'"},
      {"led", {}, "stopped"},
      {"pulse 0 x1", {}, "not verified: nobody could do 'pulse 0 x1'"},
      {"reset", {}, "not verified: nobody could do 'reset'"},
  };
  for (const Row& row : kRows) {
    answers = row.answers;
    EXPECT_EQ(answer_of(rig, row.request), row.result) << row.request;
    EXPECT_TRUE(answers.empty());
  }
  EXPECT_EQ(questions.size(), 12U);
  EXPECT_EQ(questions.front(), "Switch the supply off; Enter: done, s: cannot be done ");
}

/// The person can do all at once, but sees nothing.

}  // namespace
}  // namespace ex9000::utility
