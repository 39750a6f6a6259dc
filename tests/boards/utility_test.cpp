// The program ex9000 with images in an emulator. The test is built for each emulator.
#include <gtest/gtest.h>

#include <regex>

#include EX9000_TARGET_HEADER
#include "sim/utility/verify/verify.hpp"
#include "tests/sim/utility/target_line.hpp"
#include "tests/support/directory.hpp"

namespace ex9000::utility {
namespace {

using sim::Words;

class Utility : public testing::Test {
 protected:
  explicit Utility(const char* model = "EX9052D-M") : model_(*find_model(model)) {
    Settings settings = Settings::factory(model_);
    settings.address = 5;
    settings.serial_number = 0x0D00A55A;
    target_.start(model_, &settings);
  }
  ~Utility() override { EXPECT_NO_THROW(target_.end()); }

  void run(const Words& words) { EXPECT_EQ(program_.run(words), 0) << program_.output() << program_.error(); }
  /// Runs the program in one mode of the line.
  void run(Words words, const std::string& baud) {
    words.insert(words.end(), {"--baud", baud, "--format", "8N1"});
    run(words);
  }
  void power_cycle() {
    target_.power(false);
    target_.power(true);
  }
  void has(const std::string& text) const {
    EXPECT_NE(program_.output().find(text), std::string::npos) << text << "\n" << program_.output();
  }

  std::string settings_shown() {
    run({"show", "port", "5"}, "9600");
    return program_.output().substr(0, program_.output().find("state\n"));
  }
  /// Verifies the module with transcripts. Returns the report without the line about the port.
  std::string verify(const Words& files) {
    std::vector<play::Transcript> transcripts;
    for (const std::string& file : files) {
      const std::vector<play::Transcript> loaded = play::load_all(file);
      transcripts.insert(transcripts.end(), loaded.begin(), loaded.end());
    }
    program_.clear();
    Environment environment = program_.environment();
    TargetRig rig(target_);
    utility::verify(environment, {{}, at_address(5), transcripts, &model_, {}}, rig);
    return std::regex_replace(program_.output(), std::regex("port: [^\n]*\n"), "");
  }

  const Model& model_;
  EX9000_TARGET target_;
  Program program_{[this](hal::SerialMode mode) {
    return std::make_unique<TargetLine>(target_, mode, [this] { return target_.now(); });
  }};
  const system::Directory directory_;
};

// The values are those of wire.md, section 2, and of extensions.md.
TEST_F(Utility, FindsShowsSetsSavesAndRestoresAModule) {
  const std::string kFound =
      " baud 8N1  EX9052D-M '9052M'  D01.00  0D00A55A  last reset: " EX9000_LAST_RESET "\n";
  run({"scan", "port", "--fast"}, "9600");
  EXPECT_EQ(program_.output(), "5 (05)  modbus 9600" + kFound);
  target_.set_input(2, true);
  const std::string before = settings_shown();
  EXPECT_EQ(before, R"(EX9052D-M '9052M', firmware D01.00, serial number 0D00A55A, Modbus at 9600 baud 8N1
settings
  protocol          modbus
  baud              9600
  format            8N1
)" EX9000_UPDATES R"(  name              9052M
  edge              falling
  input-filters     0
  inverted-inputs   0000
  watchdog-timeout  25.5s
  watchdog-feed     host-ok
  response-delay    0
  address           5
  watchdog          off
)");
  has("\n  inputs            04\n");
  const std::string file = directory_ / "module.yaml";
  run({"save", "port", "5", file}, "9600");

  run({"set", "port", "5", "inverted-inputs=0001", "protocol=ascii", "baud=19200"}, "9600");
  EXPECT_EQ(program_.output(),
            "protocol: modbus -> ascii, in force from the next reset on\n"
            "baud: 9600 -> 19200, in force from the next reset on\n"
            "inverted-inputs: 0000 -> 0001\n"
            "switch the module off and on\n");
  run({"poll", "port", "5", "--count", "1"}, "9600");
  has("inputs 05 ");
  power_cycle();
  run({"scan", "port", "--addresses", "4-6"}, "19200");
  EXPECT_EQ(program_.output(), "5 (05)  ascii 19200" + kFound);

  target_.set_init(true);
  power_cycle();
  run({"restore", "port", "0", file, "--entry", "5"}, "9600");
  EXPECT_EQ(program_.output(),
            "protocol: ascii -> modbus, in force from the next reset on\n"
            "baud: 19200 -> 9600, in force from the next reset on\n"
            "inverted-inputs: 0001 -> 0000\n"
            "release INIT*, and switch the module off and on\n");
  target_.set_init(false);
  power_cycle();
  EXPECT_EQ(settings_shown(), before);
  has("\n  inputs            04\n");
}

TEST_F(Utility, VerifiesAModuleWithInputs) {
  const std::string before = settings_shown();
  const std::string wrong = directory_ / "wrong.txt";  // two pulses are counted as two
  system::write_file(wrong,
                     "source: -\nmodel: EX9052D-M\npreset: protocol=ascii\npulse 3 x2\n> #013\n< !0100003\n");
  EXPECT_EQ(verify({"tests/conformance/modbus/requests/46.txt", "tests/conformance/dcon/init/until-reset.txt",
                    "tests/conformance/dcon/inputs/latches.txt",
                    "tests/conformance/dcon/persistence/name.txt", wrong}),
            "ex9000 D01.00\n"
            "module: EX9052D-M, name 9052M, version D01.00, serial number 0D00A55A\n"
            "passed        tests/conformance/modbus/requests/46.txt (EX9052D-M): 12 steps\n"
            "passed        tests/conformance/dcon/init/until-reset.txt (EX9052D-M): 16 steps\n"
            "passed        tests/conformance/dcon/inputs/latches.txt (EX9052D-M): 67 steps\n"
            "passed        tests/conformance/dcon/persistence/name.txt (EX9052D-M): 16 steps\n"
            "FAILED        " +
                wrong +
                ":6: < !0100003: expected '!0100003\\r', received '!0100002\\r' (EX9052D-M)\n"
                "settings restored\n"
                "5 runs, 114 steps: 4 passed, 1 failed, 0 not verified\n");
  EXPECT_EQ(settings_shown(), before);
}

class UtilityOutputs : public Utility {
 protected:
  UtilityOutputs() : Utility("EX9043D-M") {}
};

TEST_F(UtilityOutputs, AreVerifiedWithTheLed) {
  EXPECT_EQ(verify({"tests/conformance/dcon/watchdog/outputs-do-not-restart.txt"}),
            "ex9000 D01.00\n"
            "module: EX9043D-M, name 9043M, version D01.00, serial number 0D00A55A\n"
            "passed        tests/conformance/dcon/watchdog/outputs-do-not-restart.txt (EX9043D-M): 16 steps\n"
            "settings restored\n"
            "1 runs, 16 steps: 1 passed, 0 failed, 0 not verified\n");
}

}  // namespace
}  // namespace ex9000::utility
