// Tests scenarios, `play` with files and folders, and the syntax of steps. The steps of a scenario may use
// several modules and lines.
#include <gtest/gtest.h>

#include <filesystem>
#include <stdexcept>
#include <string>
#include <vector>

#include "sim/app/main/play_record.hpp"
#include "sim/app/play/line_target.hpp"
#include "sim/app/play/play.hpp"
#include "sim/app/play/player.hpp"
#include "sim/app/play/transcript.hpp"
#include "sim/app/setup/bus_file.hpp"
#include "sim/files_and_ports/files/eeprom_file.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/virtual_line/wires/module.hpp"
#include "tests/support/directory.hpp"

namespace ex9000::play {
namespace {

using system::bytes_of_file;
using system::Directory;
using system::write_file;

const sim::Setup& two_lines() {
  static const sim::Setup kSetup = sim::parse_bus_file("bus.json", R"({"lines": [
    {"name": "hall", "modules": [{"model": "EX9042D"}, {"model": "EX9052D", "address": "02"}]},
    {"name": "yard", "baud": 19200, "modules": [{"model": "EX9068D-M", "address": "0A", "baud": 19200}]}]})");
  return kSetup;
}

/// Plays `steps` and returns the failure; empty if the run passes.
std::string failure_of(const std::string& steps, const sim::Setup& setup = two_lines()) {
  const Directory directory;
  write_file(directory / "steps.txt", steps);
  LineTarget target(setup, read_memories(setup));
  return play(load(directory / "steps.txt").front(), target).failure;
}

TEST(Scenario, RequestsGetTheRepliesOfTheModulesOfALine) {
  EXPECT_EQ(failure_of("> $01M\n< !019042D\n> $02M\n< !029052\n> $0AM\nsilence\n"), "");
}

TEST(Scenario, ModuleSelectsTheModuleForInputsAndOutputs) {
  EXPECT_EQ(failure_of("> @010005\n< >\noutputs 0005\nmodule 2\noutputs 0000\ninput 3 on\n> @02\n< >0800\n"),
            "");
  EXPECT_EQ(failure_of(
                "module 3\n=> 0A 05 00 01 FF 00\n<= 0A 05 00 01 FF 00\noutputs 0002\nmodule 1\noutputs 0000\n"
                "> $01M\n< !019042D\n"),
            "");
}

TEST(Scenario, LineSelectsTheLineAndItsFirstModule) {
  EXPECT_EQ(
      failure_of("line yard\n=> 0A 05 00 00 FF 00\n<= 0A 05 00 00 FF 00\noutputs 0001\n> $01M\nsilence\n"
                 "line hall\noutputs 0000\n> $01M\n< !019042D\n"),
      "");
}

TEST(Scenario, AllLinesHaveTheSameTime) {
  EXPECT_EQ(failure_of("> ~013105\n< !01\nline yard\nwait 0.6s\nline hall\nled flashing\n> ~010\n< !0184\n"),
            "");
}

// At 9600 baud, the first byte of the reply ends 2.1 ms after the end of the request if the reply is not
// late.
TEST(Scenario, SilencePassesIfNoByteArrivesFor250ms) {
  EXPECT_NE(failure_of("fault late-reply 247500us\n> $01M\nsilence\n"), "");
  EXPECT_EQ(failure_of("fault late-reply 248500us\n> $01M\nsilence\n< !019042D\n"), "");
}

TEST(Scenario, FaultsAffectTheSelectedLineOrTheSelectedModule) {
  EXPECT_EQ(failure_of("fault lost-reply\n> $01M\nsilence\nfault off 1\n> $01M\n< !019042D\n"), "");
  EXPECT_EQ(failure_of("3 fault lost-reply\nline yard\n=> 0A 01 0000 0008\nsilence\nfault off 1\n"
                       "=> 0A 01 0000 0008\n<= 0A 01 01 00\n"),
            "");
  EXPECT_EQ(
      failure_of(
          "line yard\nfault gone for 1s\n=> 0A 01 00 00 00 08\nsilence\nline hall\n> $01M\n< !019042D\n"),
      "");
}

TEST(Scenario, BytesReceivedOnALineThatIsNotSelectedAreDiscarded) {
  const std::string talk = "fault foreign-traffic 3130 every 10s\n";
  EXPECT_EQ(failure_of(talk + "line yard\nwait 31s\nline hall\nmodule 2\n> $02M\n< !029052\n"), "");
  EXPECT_EQ(failure_of(talk + "module 3\nwait 31s\nmodule 1\n> $01M\n< !019042D\n"), "");
  EXPECT_NE(failure_of(talk + "wait 31s\n").find("expected nothing, received '10"), std::string::npos);
  // After the choice of another module on the same line, the late reply is still reported as unexpected.
  EXPECT_NE(failure_of("fault late-reply 100ms\n> $01M\nmodule 2\nwait 1s\n").find("received '!019042D"),
            std::string::npos);
}

TEST(Scenario, AFailureNamesTheFileTheLineNumberTheStepAndTheReceivedBytes) {
  const std::string failure = failure_of("; a comment\n> $01M\n< !019043D\n");
  EXPECT_NE(failure.find("steps.txt:3: < !019043D: expected '!019043D\\r', received '!019042D\\r'"),
            std::string::npos)
      << failure;
}

/// Plays a file or folder. Returns the error message, or the printed text followed by `passed` or `failed`.
std::string played(const std::string& path, bool on_a_bus, const sim::Writing& writing = {}) {
  std::string text;
  const auto print = [&](const std::string& line) { text += line + "\n"; };
  try {
    sim::PlayRecord record(writing, print);
    const bool passed =
        play({path, on_a_bus ? std::optional(two_lines()) : std::nullopt, writing}, print, record);
    return text + (passed ? "passed" : "failed");
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
}

TEST(Play, ReportsEachRunAndTheTotal) {
  const Directory directory;
  write_file(directory / "a.txt", "source: manual\nmodel: EX9042D\nmodel: EX9043D\n\n> $01F\n< !01D01.00\n");
  write_file(directory / "b.txt", "source: manual\nmodel: EX9042D\n\n> $01M\n< !019043D\n");
  const std::string text = played(directory.path(), false);
  EXPECT_NE(text.find("passed  " + (directory / "a.txt") + " (EX9042D): 2 steps\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find("passed  " + (directory / "a.txt") + " (EX9043D): 2 steps\n"), std::string::npos)
      << text;
  EXPECT_NE(text.find("FAILED  " + (directory / "b.txt") + ":5: < !019043D"), std::string::npos) << text;
  EXPECT_NE(text.find("3 runs, 6 steps, 1 failed\nfailed"), std::string::npos) << text;
}

TEST(Play, PrintsTheBusLogIfRequested) {
  const Directory directory;
  write_file(directory / "a.txt", "source: manual\nmodel: EX9042D\n\n> $01M\n< !019042D\n");
  const std::string text = played(directory / "a.txt", false, {sim::LogFormat::Text, std::nullopt});
  const auto begins = text.find("plays   " + (directory / "a.txt") + " (EX9042D)\n");
  const auto asks = text.find("$01M");
  const auto answers = text.find("!019042D");
  const auto passes = text.find("passed  ");
  EXPECT_TRUE(begins < asks && asks < answers && answers < passes && passes != std::string::npos) << text;
}

TEST(Play, TheLogNamesTheLineAndItsFaults) {
  const Directory directory;
  write_file(
      directory / "a.txt",
      "fault gone every 5s for 1s\nwait 5s\n> $01M\nsilence\nline yard\nbaud 19200\n=> 0A 01 0000 0008\n"
      "<= 0A 01 01 00\n");
  const std::string text = played(directory / "a.txt", true, {sim::LogFormat::Text, std::nullopt});
  EXPECT_NE(text.find("hall:     5."), std::string::npos) << text;
  EXPECT_NE(text.find("fault 1 "), std::string::npos) << text;
  EXPECT_NE(text.find("yard:     5."), std::string::npos) << text;
}

TEST(Play, RefusesStepsThatDoNotFitTheBusBeforePlaying) {
  struct Wrong {
    const char* step;
    const char* what;
    const char* mend;
  };
  for (const Wrong& wrong :
       {Wrong{"module 4", "no module 4", "expected a position from 1 to 3"},
        Wrong{"line shed", "no line 'shed'", "expected one of hall, yard"},
        Wrong{"input 0 on", "the EX9042D has no input '0'", "it has none"},
        Wrong{"module 2\npulse 8", "the EX9052D has no input '8'", "it has 0 to 7"},
        Wrong{"fault lost", "'lost' is not a fault", "expected one of bit-errors"},
        Wrong{"4 fault gone", "no module 4", "expected a position from 1 to 3"},
        Wrong{"0 fault gone", "no module 0", "expected a position from 1 to 3"},
        Wrong{"2 fault", "expected N fault FAULT", ""},
        Wrong{"1 fault bit-errors 0.1", "concerns the line, not a module", "add it as a fault of the line"},
        Wrong{"fault off", "fault off", "K|all"}}) {
    const Directory directory;
    const std::string file = directory / "a.txt";
    write_file(file, std::string("> $01M\n< !019042D\n") + wrong.step + "\n");
    write_file(directory / "capture", "precious");
    const std::string text = played(file, true, {sim::LogFormat::Text, directory / "capture"});
    const bool second = std::string(wrong.step).find('\n') != std::string::npos;
    const std::string step =
        std::string(wrong.step).substr(second ? std::string(wrong.step).find('\n') + 1 : 0);
    EXPECT_EQ(text.rfind(file + (second ? ":4: " : ":3: ") + step + ": ", 0), 0U) << text;
    EXPECT_NE(text.find(wrong.what), std::string::npos) << text;
    EXPECT_NE(text.find(wrong.mend), std::string::npos) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << text;
    EXPECT_EQ(bytes_of_file(directory / "capture"), "precious");
  }
}

TEST(Play, WhatDependsOnTheStateOfAModuleIsJudgedWhenItIsPlayed) {
  const Directory directory;
  const std::string file = directory / "a.txt";
  write_file(file,
             "1 fault gone for 200ms\nwait 1s\n1 reset\npower off\n1 fault gone\npower on\nfault off 2\n");
  EXPECT_EQ(played(file, true).rfind("passed  ", 0), 0U) << played(file, true);
  write_file(file, "power off\nreset\n");
  EXPECT_EQ(played(file, true).rfind("FAILED  " + file + ":2: reset: the module has no power", 0), 0U)
      << played(file, true);
  write_file(file, "fault off 1\n");
  EXPECT_EQ(played(file, true).rfind("FAILED  " + file + ":1: fault off 1: no fault 1 on this line", 0), 0U)
      << played(file, true);
}

sim::Setup with_eeprom(const std::string& path) {
  sim::Setup setup;
  setup.lines.emplace_back();
  setup.lines[0].modules.push_back(sim::parse_module_spec("EX9042D,eeprom=" + path));
  return setup;
}

/// Returns an EEPROM image of an EX9042D at address 07.
std::string image_at_07() {
  const auto image = sim::SimulatedModule::memory_image(*find_model("EX9042D"),
                                                        sim::parse_module_spec("EX9042D@07").settings);
  return {image.begin(), image.end()};
}

TEST(Play, ReadsAnEepromFileThatIsReadOnlyOrInUse) {
  const Directory directory;
  write_file(directory / "eeprom", image_at_07());
  const sim::EepromFile held(directory / "eeprom");
  EXPECT_EQ(failure_of("> $07M\n< !079042D\n> ~07OPUMP\n< !07\n", with_eeprom(directory / "eeprom")), "");
  std::filesystem::permissions(directory / "eeprom", std::filesystem::perms::owner_read);
  EXPECT_EQ(failure_of("> $07M\n< !079042D\n", with_eeprom(directory / "eeprom")), "");
  EXPECT_EQ(bytes_of_file(directory / "eeprom"), image_at_07());
  EXPECT_EQ(failure_of("> $01M\n< !019042D\n", with_eeprom(directory / "none")), "");
  EXPECT_FALSE(std::filesystem::exists(directory / "none"));
}

TEST(Play, RefusesAnInvalidEepromFileBeforeOverwritingTheCapture) {
  const Directory directory;
  write_file(directory / "a.txt", "> $01M\n< !019042D\n");
  write_file(directory / "eeprom", "short");
  write_file(directory / "capture", "precious");
  const sim::Writing writing{std::nullopt, directory / "capture"};
  sim::PlayRecord record(writing, nullptr);
  for (const std::string& path : {directory / "eeprom", directory.path()}) {
    try {
      play({directory / "a.txt", with_eeprom(path), writing}, nullptr, record);
      FAIL() << "the steps were played";
    } catch (const std::invalid_argument& error) {
      EXPECT_EQ(std::string(error.what()).rfind("EX9042D,eeprom=" + path + ": eeprom=: " + path + ": ", 0),
                0U)
          << error.what();
    }
  }
  EXPECT_EQ(bytes_of_file(directory / "capture"), "precious");
}

TEST(Play, RefusesACaptureThatWouldOverwriteAnotherFileOfTheRun) {
  const Directory directory;
  write_file(directory / "a.txt", "> $07M\n< !079042D\n");
  write_file(directory / "eeprom", image_at_07());
  write_file(directory / "bus.json", "not read here");
  std::filesystem::create_symlink(directory / "a.txt", directory / "link");
  std::filesystem::create_hard_link(directory / "eeprom", directory / "other");
  std::filesystem::create_symlink("/dev/null", directory / "tty");
  sim::Setup setup = with_eeprom(directory / "eeprom");
  setup.file = directory / "bus.json";
  setup.control = directory / "ctl";
  setup.lines[0].ports.push_back(sim::parse_port("pty:" + (directory / "tty")));
  for (const auto& [capture, what] : std::vector<std::pair<std::string, std::string>>{
           {directory / "a.txt", "the file of steps " + (directory / "a.txt")},
           {directory / "link", "the file of steps " + (directory / "a.txt")},
           {directory / "eeprom", "a module's EEPROM file " + (directory / "eeprom")},
           {directory / "other", "a module's EEPROM file " + (directory / "eeprom")},
           {directory / "bus.json", "the bus file " + (directory / "bus.json")},
           {directory / "../" + std::filesystem::path(directory.path()).filename().string() + "/ctl",
            "the control socket " + (directory / "ctl")},
           {"/dev/null", "the port " + (directory / "tty")}}) {
    const sim::Writing writing{std::nullopt, capture};
    sim::PlayRecord record(writing, nullptr);
    try {
      play({directory / "a.txt", setup, writing}, nullptr, record);
      FAIL() << capture;
    } catch (const std::invalid_argument& error) {
      const std::string text = error.what();
      EXPECT_EQ(text.rfind("--capture: " + capture + ": is ", 0), 0U) << text;
      EXPECT_NE(text.find(what), std::string::npos) << text;
      EXPECT_NE(text.find("which the capture would overwrite; name another path"), std::string::npos) << text;
    }
  }
  EXPECT_EQ(bytes_of_file(directory / "a.txt"), "> $07M\n< !079042D\n");
  EXPECT_EQ(bytes_of_file(directory / "eeprom"), image_at_07());
  EXPECT_EQ(bytes_of_file(directory / "bus.json"), "not read here");
  EXPECT_FALSE(std::filesystem::exists(directory / "ctl"));
}

TEST(Play, CreatesNoCaptureIfNothingCanBePlayed) {
  const Directory directory;
  const std::string capture = directory / "line.pcapng";
  EXPECT_NE(played(directory / "none.txt", false, {std::nullopt, capture}).find("none.txt"),
            std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(capture));
}

TEST(Play, RequiresABusForAScenarioAndRejectsABusForATranscript) {
  const Directory directory;
  write_file(directory / "scenario.txt", "> $01M\n< !019042D\n");
  write_file(directory / "transcript.txt", "source: manual\nmodel: EX9042D\n\n> $01M\n< !019042D\n");
  EXPECT_NE(played(directory / "scenario.txt", true).find("1 run, 2 steps, 0 failed\npassed"),
            std::string::npos);
  EXPECT_NE(played(directory / "scenario.txt", false).find("add modules or a bus file to the command line"),
            std::string::npos);
  EXPECT_NE(played(directory / "transcript.txt", true)
                .find("names its models; leave out the modules or the bus file"),
            std::string::npos);
}

TEST(Play, RefusesAFileWithoutValidSteps) {
  const Directory directory;
  EXPECT_NE(played(directory / "none.txt", true).find("none.txt: cannot be read; name a transcript"),
            std::string::npos);
  EXPECT_NE(played("/dev/zero", true).find("/dev/zero: cannot be read"), std::string::npos)
      << "/dev/zero has no end";
  EXPECT_NE(played(directory.path(), true).find("contains no .txt file; name a transcript"),
            std::string::npos);
  std::filesystem::create_directory(directory / "folder.txt");  // not a file
  EXPECT_NE(played(directory.path(), true).find("contains no .txt file; name a transcript"),
            std::string::npos);
  write_file(directory / "empty.txt", "; nothing\n");
  EXPECT_NE(played(directory / "empty.txt", true).find("has no step; add one"), std::string::npos);
  write_file(directory / "wrong.txt", "> $01M\nwiat 1s\n");
  EXPECT_NE(played(directory / "wrong.txt", true).find("wrong.txt:2: 'wiat 1s' is not a step"),
            std::string::npos);
  write_file(directory / "preset.txt", "preset: protocol=ascii\n> $01M\n");
  EXPECT_NE(
      played(directory / "preset.txt", true)
          .find("preset.txt:1: 'preset:' requires a preceding 'model:' or 'models:' line without a preset"),
      std::string::npos);
}

// --- syntax of steps ---

/// Loads a file that contains only this step. Returns the error message without the file and the line number;
/// empty if the step is valid.
std::string refusal_of(const std::string& step) {
  const Directory directory;
  write_file(directory / "steps.txt", step + "\n");
  try {
    load(directory / "steps.txt");
    return "";
  } catch (const std::invalid_argument& error) {
    const std::string place = (directory / "steps.txt") + ":1: ";
    EXPECT_EQ(std::string(error.what()).rfind(place, 0), 0U) << error.what();
    return std::string(error.what()).substr(place.size());
  }
}

TEST(Step, AcceptsValidSyntaxOnly) {
  for (const char* step :
       {"> $01M", ">", "< >", "<\t!01", "=> 01 05 0000 FF00", "bytes 01 02", "input 15 on", "pulse 0",
        "pulse 0 x1000000", "outputs 5", "outputs FFFF", "module 1", "baud 1200", "format 8E1", "wait 0s",
        "wait 1.5ms", "2 fault gone", "1 pulse 0 x5", "fault off all"}) {
    EXPECT_EQ(refusal_of(step), "") << step;
  }
  struct Wrong {
    const char* step;
    const char* what;
    const char* mend;
  };
  for (const Wrong& wrong :
       {Wrong{">$01M", "'>$01M'", "a blank after >"}, Wrong{"<=01", "'<=01'", "a blank after <="},
        Wrong{"=>", "''", "pairs of hex digits"}, Wrong{"bytes 0x01", "'0x01'", "pairs of hex digits"},
        Wrong{"bytes", "'bytes'", "bytes HEX"}, Wrong{"input 16 on", "'16'", "0 to 15"},
        Wrong{"led blink", "'blink'", "expected on, off or flashing"},
        Wrong{"input 0", "'input 0'", "input C on|off"}, Wrong{"pulse 0 x0", "'0'", "1 to 1000000"},
        Wrong{"pulse 0 5", "'5'", "for example x5"}, Wrong{"outputs 10000", "'10000'", "hex digits"},
        Wrong{"1 status", "'1 status': only reads", "expected a step that checks"},
        Wrong{"faults", "'faults' is not a step", "N ACTION"}, Wrong{"module 0", "'0'", "from 1 to"},
        Wrong{"baud 9601", "'9601'", "1200, 2400, 4800, 9600"},
        Wrong{"format 9N1", "'9N1'", "8N1, 8N2, 8E1 or 8O1"}, Wrong{"wait -1s", "'-1s'", "12.5s"},
        Wrong{"OUTPUTS 0001", "'OUTPUTS 0001' is not a step", "outputs HHHH"}}) {
    const std::string refusal = refusal_of(wrong.step);
    EXPECT_NE(refusal.find(wrong.what), std::string::npos) << wrong.step << ": " << refusal;
    EXPECT_NE(refusal.find(wrong.mend), std::string::npos) << wrong.step << ": " << refusal;
  }
}

}  // namespace
}  // namespace ex9000::play
