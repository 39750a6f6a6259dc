// `ex9000 verify` with simulated modules. A rig of this test acts on them.
#include "sim/utility/verify/verify.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <fstream>
#include <set>
#include <sstream>
#include <utility>

#include "sim/text/durations.hpp"
#include "sim/utility/verify/command_rig.hpp"
#include "sim/utility/verify/person_rig.hpp"
#include "tests/sim/utility/plant.hpp"
#include "tests/support/directory.hpp"
#include "tests/support/stored_settings.hpp"

namespace ex9000::utility {
namespace {

bool begins(const Data& frame, const std::string& text) {
  return std::equal(
      text.begin(), text.end(), frame.begin(),
      frame.size() < text.size() ? frame.begin() : frame.begin() + static_cast<long>(text.size()));
}
const std::string kFolder = "tests/conformance/";

class TestRig final : public Rig {
 public:
  explicit TestRig(Plant& plant) : plant_(plant) {}

  std::string ask(const std::string& request) override {
    requests.push_back(request);
    const std::optional<std::string> answer = answers ? answers(request) : std::nullopt;
    return answer ? *answer : plant_.act("1 " + request);
  }

  /// Before the rig acts; with an answer, it does not act.
  std::function<std::optional<std::string>(const std::string& request)> answers;
  std::vector<std::string> requests;

 private:
  Plant& plant_;
};

/// The words in front of the report's lines for runs.
const std::string kPassed = "passed        ";
const std::string kFailed = "FAILED        ";
const std::string kNotVerified = "not verified  ";

class Verify : public testing::Test {
 protected:
  explicit Verify(const std::string& module = "EX9042D@05") : plant_({module}), rig_(plant_) {}

  static std::vector<play::Transcript> load(const std::vector<std::string>& paths) {
    std::vector<play::Transcript> all;
    for (const std::string& path : paths) {
      for (play::Transcript& transcript : play::load_all(kFolder + path)) {
        all.push_back(std::move(transcript));
      }
    }
    return all;
  }
  bool verify(const std::vector<std::string>& paths, const char* model = nullptr) {
    Environment environment = plant_.environment();
    return utility::verify(
        environment, {{}, at_address(5), load(paths), model == nullptr ? nullptr : find_model(model), {}},
        rig_);
  }
  Settings stored(const char* model) { return settings_from(*find_model(model), plant_.memory().data()); }
  /// The lines that begin like this, without the beginning.
  [[nodiscard]] std::vector<std::string> lines(const std::string& beginning) const {
    std::vector<std::string> found;
    std::istringstream report(plant_.output());
    for (std::string line; std::getline(report, line);) {
      if (line.rfind(beginning, 0) == 0) {
        found.push_back(line.substr(beginning.size()));
      }
    }
    return found;
  }
  void has(const std::string& text) const {
    EXPECT_NE(plant_.output().find(text), std::string::npos) << text << "\n" << plant_.output();
  }

  Plant plant_;
  TestRig rig_;
};

TEST_F(Verify, TheReportNamesTheModuleAndEachRun) {
  EXPECT_TRUE(verify({"dcon/commands/version.txt", "dcon/inputs", "dcon/commands/names.txt"}));
  EXPECT_EQ(plant_.output(), "ex9000 " + std::string(kFirmwareVersion) + R"(
module: EX9042D, name 9042D, version D01.00, serial number 0D000001
port: , latency 0.1 ms, which is the tolerance of times
passed        tests/conformance/dcon/commands/version.txt (EX9042D): 2 steps
passed        tests/conformance/dcon/commands/names.txt (EX9042D): 64 steps
settings restored
2 runs, 66 steps: 2 passed, 0 failed, 0 not verified
)");
}

bool verifies_all() { return std::getenv("EX9000_VERIFY") != nullptr; }

/// All steps of all runs pass, but of those that a real module cannot play. With EX9000_VERIFY=all, for all
/// models.
class EachModel : public Verify, public testing::WithParamInterface<std::string> {
 protected:
  EachModel() : Verify(GetParam() + "@05") {}
};
TEST_P(EachModel, PassesAllTranscripts) {
  static const std::vector<play::Transcript> kAll = load({""});
  Environment environment = plant_.environment();
  const Model* const model = find_model(GetParam());
  EXPECT_TRUE(utility::verify(environment, {{}, at_address(5), kAll, model, {}}, rig_));
  EXPECT_EQ(lines(kFailed), std::vector<std::string>());
  std::size_t steps = 0;
  std::vector<std::string> passed;
  std::size_t beyond = 0;
  for (const play::Transcript& each : kAll) {
    if (each.model != model) {
      continue;
    }
    if (each.blank_memory || each.file.find("update") != std::string::npos) {
      ++beyond;
    } else {
      steps += each.steps.size();
      passed.push_back(each.file + " (" + each.run + "): " + std::to_string(each.steps.size()) + " steps");
    }
  }
  EXPECT_EQ(lines(kPassed), passed);
  EXPECT_EQ(lines(kNotVerified).size(), beyond);
  has("\nsettings restored\n" + std::to_string(passed.size() + beyond) + " runs, " + std::to_string(steps) +
      " steps: " + std::to_string(passed.size()) + " passed, 0 failed, " + std::to_string(beyond) +
      " not verified\n");
  std::printf("%s: %zu runs, %zu steps\n", GetParam().c_str(), passed.size(), steps);
}
std::vector<std::string> models_to_verify() {
  if (!verifies_all()) {
    return {"EX9042D", "EX9042D-M", "EX9052D-M"};
  }
  std::vector<std::string> models;
  for (const Model& model : kModels) {
    models.emplace_back(model.designation);
  }
  return models;
}
INSTANTIATE_TEST_SUITE_P(Verify, EachModel, testing::ValuesIn(models_to_verify()));

/// A module with both protocols and inputs.
class VerifyInputs : public Verify {
 protected:
  VerifyInputs() : Verify("EX9060D-M@05") {}
};

TEST_F(VerifyInputs, WhatTheRigCannotDoIsNeverPassed) {
  const std::vector<std::string> kWords{"input", "pulse", "outputs", "led", "reset"};
  const std::vector<std::string> kPaths{"dcon/watchdog/expiry.txt", "dcon/inputs/latch-high.txt",
                                        "dcon/persistence/outputs.txt"};
  for (unsigned lacking = 0; lacking < 1U << kWords.size(); ++lacking) {
    const auto lacks = [&](const std::string& word) {
      for (std::size_t i = 0; i < kWords.size(); ++i) {
        if (kWords[i] == word && (lacking >> i & 1U) != 0) {
          return true;
        }
      }
      return false;
    };
    plant_.act("1 input 0 off");
    rig_.answers = [&](const std::string& request) -> std::optional<std::string> {
      return lacks(request.substr(0, request.find(' '))) ? throw NotVerified("cannot") : std::nullopt;
    };
    std::set<std::string> played;
    std::set<std::string> others;
    for (const play::Transcript& each : load(kPaths)) {
      if (each.model == find_model("EX9060D-M")) {
        const bool complete = std::none_of(each.steps.begin(), each.steps.end(),
                                           [&](const play::Step& step) { return lacks(step.words()[0]); });
        (complete ? played : others).insert(each.file + " (" + each.run + ")");
      }
    }
    verify(kPaths);
    EXPECT_EQ(lines(kFailed), std::vector<std::string>());
    EXPECT_EQ(lines(kPassed).size(), played.size());
    for (const std::string& line : lines(kPassed)) {
      EXPECT_EQ(played.count(line.substr(0, line.rfind(": "))), 1U) << line;
    }
    EXPECT_EQ(lines(kNotVerified).size(), others.size()) << lacking;
    plant_.clear();
  }
}

TEST_F(VerifyInputs, WithoutSupplyOrInitNothingIsVerified) {
  for (const char* word : {"power off", "power on", "init on"}) {
    rig_.answers = [&](const std::string& request) -> std::optional<std::string> {
      return request == word ? throw NotVerified("no relay for '" + request + "'") : std::nullopt;
    };
    EXPECT_FALSE(verify({"dcon/commands/version.txt"}, "EX9060D-M"));
    EXPECT_TRUE(plant_.sent.empty());
    EXPECT_EQ(plant_.output(), "ex9000 " + std::string(kFirmwareVersion) +
                                   "\nmodule: not read: no relay for '" + word +
                                   "'\nnot verified  tests/conformance/dcon/commands/version.txt "
                                   "(EX9060D-M): no relay for '" +
                                   word + "'\n1 runs, 0 steps: 0 passed, 0 failed, 1 not verified\n");
    plant_.clear();
  }
  NoRig none;
  Environment environment = plant_.environment();
  EXPECT_FALSE(utility::verify(
      environment, {{}, at_address(5), load({"dcon/commands/version.txt"}), find_model("EX9060D-M"), {}},
      none));
  has("(EX9060D-M): 'power off' requires a rig; see --rig\n");
}

TEST_F(VerifyInputs, AModuleWhoseInputsAreOnCannotStart) {
  plant_.act("1 input 2 on");
  rig_.answers = [&](const std::string& request) -> std::optional<std::string> {
    return request.rfind("input", 0) == 0 ? throw NotVerified("no relay for '" + request + "'")
                                          : std::nullopt;
  };
  EXPECT_FALSE(verify({"dcon/commands/version.txt"}));
  has("not verified  tests/conformance/dcon/commands/version.txt (EX9060D-M): no relay for 'input 0 off'\n");
}

TEST_F(VerifyInputs, AModuleThatRefusesTheSettingsAtTheStartIsNotVerified) {
  plant_.sends = [&](const Data& frame) {
    plant_.act(begins(frame, "%0001400A") ? "1 fault exception 03 every reply" : "fault off all");
    return true;
  };
  EXPECT_FALSE(verify({"dcon/extensions/line-format-stop-bits.txt"}));
  has("in INIT mode, the module refuses '%0001400A00'\n");
  EXPECT_EQ(lines(kFailed).size(), 0U);
}

TEST_F(VerifyInputs, ARunThatIsTooFastForThePortIsNotVerified) {
  plant_.delay = std::chrono::milliseconds(3);
  verify({"modbus/framing/second-frame-old-address.txt", "dcon/inputs/latches.txt"});
  has("port: , latency 3.");
  EXPECT_EQ(lines(kPassed).size(), 1U);
  has("' is too short for the port\n");
}

TEST_F(VerifyInputs, APortThatDelaysRepliesFailsNoRun) {
  for (const int delay : {1, 4, 16}) {  // 16 ms: USB adapters of FTDI
    plant_.delay = std::chrono::milliseconds(delay);
    EXPECT_TRUE(verify({"dcon/watchdog", "modbus/watchdog"})) << plant_.output();
    EXPECT_GE(lines(kPassed).size(), 39U);
    plant_.clear();
  }
}

// Settings before and after.

class Restored : public Verify {
 protected:
  Restored() : Verify("EX9060D-M@05,baud=19200,format=8E1,edge=rising,name=Pump") {
    for (const char* request : {"05 06 0240 0003", "05 06 0250 0005", "05 06 0251 0001", "05 06 0252 000A",
                                "05 05 0081 FF00", "05 05 00A2 FF00", "05 06 01E8 00C8", "05 05 0104 FF00"}) {
      EXPECT_EQ(plant_.run({"send", "port", request, "--baud", "19200", "--format", "8E1"}), 0)
          << plant_.output();
    }
    before_ = stored(kModel);
  }

  static constexpr const char* kModel = "EX9060D-M";
  /// These change all settings.
  const std::vector<std::string> paths_{
      "dcon/persistence/all-together.txt",   "dcon/extensions/filter-values.txt",
      "modbus/extensions/serial-number.txt", "modbus/extensions/delay-register.txt",
      "modbus/extensions/inversion.txt",     "modbus/extensions/any-request-values.txt"};
  Settings before_;
};

TEST_F(Restored, AreTheSettingsAfterASuccess) {
  EXPECT_TRUE(verify(paths_, kModel)) << plant_.output();
  EXPECT_EQ(lines(kPassed).size(), 6U) << plant_.output();
  EXPECT_EQ(stored(kModel), before_);
}

TEST_F(Restored, AreTheSettingsAfterAFailure) {
  plant_.sends = [](const Data& frame) { return !begins(frame, "$E3M"); };
  EXPECT_FALSE(verify(paths_, kModel));
  EXPECT_EQ(lines(kFailed).size(), 1U);
  EXPECT_EQ(stored(kModel), before_);
}

/// Each fifth frame, also of those that restore them; with EX9000_VERIFY=all, each frame.
TEST_F(Restored, AreTheSettingsAfterAnInterruptionAtAnyFrame) {
  const std::vector<std::string> some{paths_.begin(), paths_.begin() + 3};
  const std::size_t step = verifies_all() ? 1 : 5;
  std::size_t runs = 0;
  for (bool interrupted = true; interrupted; ++runs) {
    interrupted = false;
    plant_.sends = [&, frame = std::size_t{0}](const Data& /*frame*/) mutable {
      interrupted = interrupted || frame == runs * step;
      return frame++ == runs * step ? throw Interrupted() : true;
    };
    try {
      verify(some, kModel);
    } catch (const Interrupted&) {  // NOLINT(bugprone-empty-catch)
      // but not if it was restoring the settings
    }
    ASSERT_EQ(stored(kModel), before_) << runs * step << "\n" << plant_.output();
    plant_.clear();
  }
  EXPECT_GT(runs * step, 300U);
  std::printf("%zu interruptions\n", runs - 1);
}

TEST_F(Restored, AreNotTheSettingsAfterTwoInterruptions) {
  bool stopped = false;
  plant_.sends = [&](const Data& frame) {
    stopped = stopped || begins(frame, "~E32");
    return stopped ? throw Interrupted() : true;
  };
  EXPECT_THROW(verify(paths_, kModel), Interrupted);
  has("settings NOT restored: stopped\n");
}

TEST_F(Restored, IsTheTimeoutStatus) {
  plant_.run({"send", "port", "05 06 01E8 0003", "--baud", "19200", "--format", "8E1"});
  plant_.run({"send", "port", "05 01 0080 0001", "--baud", "19200", "--format", "8E1"});
  plant_.act("1 power off");
  plant_.act("1 power on");
  plant_.wait(std::chrono::seconds(1));
  before_ = stored(kModel);
  ASSERT_TRUE(before_.timeout_status);
  EXPECT_TRUE(verify({"dcon/commands/version.txt"}, kModel));
  EXPECT_EQ(stored(kModel), before_);
}

TEST_F(Restored, IsReportedIfItFails) {
  std::size_t left = 20;
  rig_.answers = [&](const std::string& /*request*/) -> std::optional<std::string> {
    return --left == 0 ? throw std::runtime_error("--rig: smoke") : std::nullopt;
  };
  EXPECT_THROW(verify(paths_, kModel), std::runtime_error);
  left = 20;
  rig_.answers = [&](const std::string& /*request*/) -> std::optional<std::string> {
    return left == 0 || --left == 0 ? throw std::runtime_error("--rig: smoke") : std::nullopt;
  };
  EXPECT_THROW(verify(paths_, kModel), std::runtime_error);
  has("settings NOT restored: --rig: smoke\nin INIT mode, these commands change those of the factory to what "
      "was "
      "there: @004 ~005P @002 ~005S ~00OPump ~00X02400003 ~00X02500005 ~00X02510001 ~00X0252000A "
      "%0005408780 ~0031C8\n");
}

// Faulty modules.

struct Mutant {
  const char* model;
  const char* failure;  ///< how its line in the report begins
  void (*spoil)(Plant& plant, TestRig& rig);
};

/// Byte `at` of the replies to requests that begin like this becomes another one.
void change(Plant& plant, const std::string& request, std::size_t at, std::uint8_t from, std::uint8_t to) {
  plant.hears = [=, &plant](std::size_t position, std::uint8_t byte) {
    return begins(plant.sent.back(), request) && position == at && byte == from ? to : byte;
  };
}
void ignore(TestRig& rig, const std::string& word) {
  rig.answers = [=](const std::string& request) {
    return request.rfind(word, 0) == 0 ? std::optional(std::string()) : std::nullopt;
  };
}

/// The fault begins when a frame begins like this, and ends when the supply is switched off.
void fault(Plant& plant, TestRig& rig, const std::string& request, const std::string& action) {
  plant.sends = [=, &plant](const Data& frame) {
    if (begins(frame, request)) {
      plant.act(action);
    }
    return true;
  };
  rig.answers = [&plant](const std::string& word) -> std::optional<std::string> {
    if (word == "power off") {
      plant.act("fault off all");
    }
    return std::nullopt;
  };
}

const std::vector<Mutant> kMutants{
    {"EX9042D", "dcon/commands/names.txt:7: < !01: expected '!01\\r', received '>01\\r' (EX9042D)\n",
     [](Plant& plant, TestRig&) { change(plant, "~01O", 0, '!', '>'); }},
    {"EX9042D", "dcon/framing/checksum-right.txt:17: < ?01: expected '?01A0\\r', received '!01A0\\r'",
     [](Plant& plant, TestRig&) { change(plant, "$01Z", 0, '?', '!'); }},
    {"EX9042D", "dcon/framing/checksum-right.txt:12: < !019042D: ",
     [](Plant& plant, TestRig&) {
       constexpr std::size_t kLastDigit = 9;
       plant.hears = [&plant](std::size_t at, std::uint8_t byte) {
         return static_cast<std::uint8_t>(begins(plant.sent.back(), "$01M") && at == kLastDigit ? byte ^ 1U
                                                                                                : byte);
       };
     }},
    {"EX9042D", "dcon/commands/status.txt:11: < !011: expected '!011\\r', received nothing",
     [](Plant& plant, TestRig&) { plant.sends = [](const Data& frame) { return !begins(frame, "$015"); }; }},
    {"EX9042D", "dcon/persistence/name.txt:10: < !01Pump 1: expected '!01Pump 1\\r', received nothing",
     [](Plant& plant, TestRig& rig) { fault(plant, rig, "$01M", "1 fault late-reply 300ms"); }},
    {"EX9042D", "dcon/framing/foreign-address.txt:19: > $024: expected nothing, received '!02\\r'",
     [](Plant& plant, TestRig&) {
       plant.sends = [&plant](const Data& frame) {
         if (begins(frame, "$022")) {
           const Time later = plant.now() + std::chrono::milliseconds(20);
           plant.act("fault foreign-traffic 2130320D at " + sim::seconds_text(later) + "s");
         }
         return true;
       };
     }},
    {"EX9052D", "dcon/inputs/latches.txt:36: < !810000: expected '!810000\\r', received '!000000\\r'",
     [](Plant&, TestRig& rig) { ignore(rig, "pulse"); }},
    {"EX9042D", "dcon/commands/version.txt:7: < !7FD01.00: expected '!7FD01.00\\r', received '!7FD01.0\\r'",
     [](Plant& plant, TestRig&) {
       constexpr std::size_t kLastDigit = 8;
       plant.hears = [&plant](std::size_t at, std::uint8_t byte) {
         return begins(plant.sent.back(), "$7FF") && at == kLastDigit ? std::nullopt : std::optional(byte);
       };
     }},
    {"EX9042D-M",
     "modbus/requests/46.txt:7: <= 01 46 00 00 90 42 00: expected 01 46 00 00 90 42 00 35 EB (9 bytes), "
     "received ",
     [](Plant& plant, TestRig&) {
       constexpr std::size_t kCrc = 8;
       plant.hears = [&plant](std::size_t at, std::uint8_t byte) {
         return static_cast<std::uint8_t>(begins(plant.sent.back(), "\x01\x46") && at == kCrc ? byte ^ 1U
                                                                                              : byte);
       };
     }},
    {"EX9042D-M",
     "modbus/extensions/identity.txt:17: <= 01 86 02: expected 01 86 02 C3 A1 (5 bytes), received 01 86 03 "
     "02 61 (5 bytes)",
     [](Plant& plant, TestRig& rig) { fault(plant, rig, "\x01\x06", "1 fault exception 03 every reply"); }},
    {"EX9052D", "dcon/inputs/counter-wrap.txt:16: < !0100000: expected '!0100000\\r', received '!0100001\\r'",
     [](Plant& plant, TestRig&) {
       constexpr std::size_t kLastDigit = 7;
       change(plant, "#017", kLastDigit, '0', '1');
     }},
    {"EX9042D", "dcon/persistence/name.txt:13: < !01Pump 1: expected '!01Pump 1\\r', received '!019042D\\r'",
     [](Plant& plant, TestRig& rig) {
       rig.answers = [&](const std::string& request) -> std::optional<std::string> {
         const bool in_a_cycle = rig.requests.size() > 1 && *(rig.requests.end() - 2) == "power off";
         if (request == "power on" && in_a_cycle) {
           std::fill(plant.memory().begin(), plant.memory().end(), std::uint8_t{0xFF});
         }
         return std::nullopt;
       };
     }},
    {"EX9042D", "dcon/watchdog/expiry.txt:19: outputs 0002: outputs are 0000",
     [](Plant& plant, TestRig& rig) {
       rig.answers = [&plant](const std::string& request) -> std::optional<std::string> {
         const bool dead = request == "outputs" && plant.act("1 outputs") == "0002";
         return dead ? std::optional<std::string>("0000") : std::nullopt;
       };
     }},
    {"EX9042D", "dcon/watchdog/expiry.txt:20: led flashing: the LED is on",
     [](Plant&, TestRig& rig) {
       rig.answers = [](const std::string& request) {
         return request == "led" ? std::optional<std::string>("on") : std::nullopt;
       };
     }},
    {"EX9042D", "dcon/init/until-reset.txt:11: < !01400600: expected '!01400600\\r', received nothing",
     [](Plant&, TestRig& rig) {
       rig.answers = [&rig](const std::string& request) -> std::optional<std::string> {
         const bool starts = rig.requests.size() > 1 && *(rig.requests.end() - 2) == "power off";
         return request == "init on" && !starts ? std::optional<std::string>("") : std::nullopt;
       };
     }},
    {"EX9042D", "dcon/persistence/baud.txt:9: < !01: expected '!01\\r', received nothing",
     [](Plant& plant, TestRig& rig) { fault(plant, rig, "%01", "1 fault wrong-rate 19200"); }},
};

TEST(Mutants, EachIsReportedAtItsLine) {
  for (const Mutant& mutant : kMutants) {
    SCOPED_TRACE(mutant.failure);
    Plant plant({std::string(mutant.model) + "@05"});
    TestRig rig(plant);
    mutant.spoil(plant, rig);
    const std::string failure = mutant.failure;
    std::vector<play::Transcript> file = play::load_all(kFolder + failure.substr(0, failure.find(':')));
    Environment environment = plant.environment();
    EXPECT_FALSE(utility::verify(environment, {{}, at_address(5), file, nullptr, {}}, rig));
    EXPECT_NE(plant.output().find("\n" + kFailed + kFolder + failure), std::string::npos) << plant.output();
    EXPECT_NE(plant.output().find("\nsettings restored\n"), std::string::npos) << plant.output();
  }
}

TEST_F(VerifyInputs, APersonIsNotAskedForARunInVain) {
  std::size_t questions = 0;
  PersonRig person([&](const std::string& question) -> std::optional<std::string> {
    ++questions;
    const sim::Words words = sim::words_of(question.substr(0, question.find(';')));
    if (words[0] == "Switch") {
      plant_.act("1 " + (words[1] == "the" ? "power " + words[3] : "input " + words[2] + " " + words[3]));
    } else if (words[0] == "Connect" || words[0] == "Disconnect") {
      plant_.act(words[0] == "Connect" ? "1 init on" : "1 init off");
    } else {
      return "s";
    }
    return "";
  });
  Environment environment = plant_.environment();
  EXPECT_TRUE(utility::verify(environment,
                              {{},
                               at_address(5),
                               load({"dcon/inputs/latches.txt", "dcon/inputs/levels-and-sample.txt",
                                     "dcon/persistence/name.txt", "dcon/watchdog/expiry.txt"}),
                               nullptr,
                               {}},
                              person));
  EXPECT_EQ(
      lines(kNotVerified),
      (std::vector<std::string>{
          kFolder + "dcon/inputs/latches.txt (EX9060D-M): line 33: 'pulse 0' is nothing that a person can do",
          kFolder + "dcon/persistence/name.txt (EX9060D-M): line 8: 'reset' is nothing that a person can do",
          kFolder + "dcon/watchdog/expiry.txt:16: outputs 0001: nobody could do 'outputs' (EX9060D-M)"}));
  EXPECT_EQ(lines(kPassed).size(), 1U);
  std::printf("%zu questions\n", questions);
}

// The command.

TEST(VerifyCommand, RefusesWrongArguments) {
  const std::string file = kFolder + "dcon/commands/version.txt";
  const std::pair<std::vector<std::string>, std::string> kRows[] = {
      {{"port", "5"}, "expected ex9000 verify PORT MODULE FILE...\n"},
      {{"port", "x", file},
       "'x': expected an address, 0 to 255 or 0x00 to 0xFF, or a serial number of 8 hex digits\n"},
      {{"port", "5", "no-such-file"}, "no-such-file: cannot be read; name a transcript"},
      {{"port", "5", file, "--model", "EX1"}, "'EX1' is not a model"},
      {{"modbus-tcp:host", "5", file}, "Modbus TCP carries no DCON; name another port\n"},
      {{"port", "5", file, "--rig", "exit"},
       "--rig: 'exit' has ended; it must answer until its input ends\n"},
      {{"port", "5", file, "--report", "no/such/folder"}, "--report: no/such/folder: cannot be written"},
  };
  for (auto [words, problem] : kRows) {
    Plant plant({"EX9042D@05"});
    words.insert(words.begin(), "verify");
    EXPECT_NE(plant.run(words), 0);
    EXPECT_EQ(plant.error().find("ex9000: " + problem), 0U) << plant.error();
    EXPECT_TRUE(plant.sent.empty());
  }
}

/// This rig says that it has done all, but it has done nothing.
TEST(VerifyCommand, AModuleThatIsNotInInitModeIsNotVerified) {
  Plant plant({"EX9042D@05"});
  const system::Directory directory;
  const std::string report = directory / "report";
  EXPECT_EQ(plant.run({"verify", "port", "5", kFolder + "dcon/commands/version.txt", "--model", "9042D",
                       "--rig", "while read -r line; do echo ok; done", "--report", report}),
            1);
  EXPECT_EQ(plant.output(), report + ": not all passed\n");
  std::ostringstream text;
  text << std::ifstream(report).rdbuf();
  EXPECT_EQ(text.str(), "ex9000 " + std::string(kFirmwareVersion) + R"(
module: not read: in INIT mode, the module gives no reply to '$002'
not verified  tests/conformance/dcon/commands/version.txt (EX9042D): in INIT mode, the module gives no reply to '$002'
1 runs, 0 steps: 0 passed, 0 failed, 1 not verified
)");
}

TEST_F(Verify, AnotherModuleIsNotTouched) {
  Environment environment = plant_.environment();
  const std::pair<Addressee, const char*> kRows[] = {
      {at_address(6), "the rig switches a module with address 5, not 6"},
      {with_serial_number(0x0D000002), "the rig switches a module with address 5, not 0D000002"}};
  for (const auto& [module, problem] : kRows) {
    rig_.requests.clear();
    try {
      utility::verify(environment, {{}, module, load({"dcon/commands/version.txt"}), nullptr, {}}, rig_);
      ADD_FAILURE();
    } catch (const std::invalid_argument& error) {
      EXPECT_STREQ(error.what(), problem);
    }
    EXPECT_EQ((std::vector<std::string>{rig_.requests.end() - 3, rig_.requests.end()}),
              (std::vector<std::string>{"power off", "init off", "power on"}));
  }
  EXPECT_TRUE(utility::verify(
      environment, {{}, with_serial_number(0x0D000001), load({"dcon/commands/version.txt"}), nullptr, {}},
      rig_));
}

}  // namespace
}  // namespace ex9000::utility
