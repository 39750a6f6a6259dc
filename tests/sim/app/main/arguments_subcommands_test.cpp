// Tests the command line of ex9000-sim: the subcommands, and the options that only print text.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "sim/app/exports/describe.hpp"
#include "sim/app/main/arguments.hpp"
#include "sim/app/setup/bus_file.hpp"
#include "sim/notation/actions.hpp"
#include "sim/notation/fault_notation.hpp"
#include "tests/sim/app/main/parsed_arguments.hpp"

namespace ex9000::sim {
namespace {

/// Expects that `words` only print text, and returns the text.
std::string printed(const std::vector<const char*>& words) {
  const Parsed parsed = parse(words);
  EXPECT_FALSE(parsed.setup);
  EXPECT_EQ(parsed.exit_status, 0);
  EXPECT_EQ(parsed.error, "");
  EXPECT_EQ(parsed.output.empty() ? ' ' : parsed.output.back(), '\n');
  return parsed.output;
}

/// Expects that `words` request the subcommand `play` and no run, and returns the task of `play`.
play::Task task_of(const std::vector<const char*>& words) {
  const Parsed parsed = parse(words);
  EXPECT_FALSE(parsed.setup);
  EXPECT_TRUE(parsed.task) << parsed.error;
  return parsed.task.value_or(play::Task());
}

TEST(Arguments, PlayAcceptsArgumentsOnlyAfterTheSubcommand) {
  const play::Task task =
      task_of({"play", "s.txt", "EX9042D", "--capture", "c", "--log", "json", "--seed", "7"});
  EXPECT_EQ(task.path, "s.txt");
  EXPECT_EQ(task.writing.capture, "c");
  EXPECT_EQ(task.writing.log, LogFormat::Json);
  ASSERT_TRUE(task.bus);
  EXPECT_EQ(task.bus->seed, 7U);
  EXPECT_EQ(task_of({"play", "play"}).path, "play");
  EXPECT_EQ(task_of({"play", "describe"}).path, "describe");
  expect_error({"--capture", "x", "play", "s.txt"}, "play: --capture comes before the subcommand",
               "move it after 'play'");
  expect_error({"--log", "play", "s.txt"}, "play: --log comes before the subcommand", "move it after 'play'");
  expect_error({"--seed", "1", "play", "s.txt"}, "play: --seed comes before the subcommand",
               "move it after 'play'");
  expect_error({"EX9042D@02", "play", "s.txt"}, "play: EX9042D@02 comes before the subcommand",
               "move it after 'play'");
  for (const char* option : {"--port", "--fault", "--control", "--speed", "--for"}) {
    expect_error({option, "1", "play", "s.txt"},
                 std::string("play: ") + option + " comes before the subcommand", "leave it out");
  }
}

TEST(Arguments, DescribeRejectsArgumentsBeforeTheSubcommand) {
  expect_error({"--log", "describe"}, "describe: --log comes before the subcommand", "leave it out");
  expect_error({"EX9042D", "describe"}, "describe: EX9042D comes before the subcommand", "leave it out");
}

TEST(Arguments, PlayRejectsAnEmptyCapturePathAndAWrongSeedEvenWithoutModules) {
  expect_error({"play", "s.txt", "--seed", "abc"}, "--seed: 'abc'",
               "a whole number from 0 to 18446744073709551615");
  expect_error({"play", "s.txt", "EX9042D", "--seed", "abc"}, "--seed: 'abc'",
               "a whole number from 0 to 18446744073709551615");
  expect_error({"play", "s.txt", "--capture", ""}, "--capture", "path");
}

TEST(Arguments, ExamplePrintsAValidBusFile) {
  EXPECT_EQ(printed({"--example"}), example_bus_file());
  EXPECT_EQ(parse_bus_file("example", printed({"--example"})).lines.size(), 2U);
}

TEST(Arguments, HelpFitsOnAScreenAndHasTopics) {
  const std::string all = printed({"--help"});
  EXPECT_LE(std::count(all.begin(), all.end(), '\n'), 45);
  EXPECT_NE(printed({"help", "faults"}).find(fault_help()), std::string::npos);
  EXPECT_NE(printed({"help", "control"}).find(action_help()), std::string::npos);
  for (const auto& [topic, word] :
       {std::pair("modules", "  eeprom=FILE                   keeps the settings"),
        std::pair("modules", "115200\n                                the baud rate"),
        std::pair("ports", "  serial:DEVICE "), std::pair("inputs", "C key at TIME"),
        std::pair("steps", "power-cycle")}) {
    EXPECT_NE(printed({"help", topic}).find(word), std::string::npos) << topic;
    EXPECT_NE(all.find(topic), std::string::npos) << topic;
  }
  expect_error({"help", "me"}, "help: 'me' is not a topic", "expected one of modules|ports");
  expect_error({"help"}, "help: '' is not a topic", "expected one of modules|ports");
}

TEST(Arguments, DescribePrintsAllModelsInMarkdownByDefault) {
  EXPECT_EQ(printed({"describe"}), describe({}));
  EXPECT_EQ(printed({"describe", "--format", "markdown"}), describe({}));
}

TEST(Arguments, DescribeAcceptsAModelNameInAnyCaseWithOrWithoutEx) {
  const std::string text = describe({"EX9052D-M"});
  for (const char* name : {"EX9052D-M", "ex9052d-m", "9052D-M", "9052d-m"}) {
    EXPECT_EQ(printed({"describe", name}), text) << name;
  }
}

TEST(Arguments, WrongDescribeArgumentsAreRefused) {
  expect_error({"describe", "EX9999"}, "describe: 'EX9999'", "--models");
  expect_error({"describe", "EX9042D@01"}, "EX9042D@01", "--models");
  expect_error({"describe", "EX9042D", "EX9060D"}, "EX9060D", "--help");
  expect_error({"describe", "EX9042D", "--pty", "x"}, "--pty", "--help");
  expect_error({"describe", "EX9042D", "--format"}, "--format", "--help");
  EXPECT_EQ(parse({"describe", "EX9999"}).exit_status, kWrongArguments);
}

TEST(Arguments, DescribeHasItsOwnHelp) {
  const std::string text = printed({"describe", "--help"});
  EXPECT_NE(text.find("Usage: ex9000-sim describe [OPTIONS]"), std::string::npos) << text;
  for (const char* word :
       {"MODEL", "--format", "csv|esphome|", "--address", "--port", "tcp:127.0.0.1:5020"}) {
    EXPECT_NE(text.find(word), std::string::npos) << word;
  }
  EXPECT_EQ(text.find("--baud"), std::string::npos);
}

TEST(Arguments, PrintsTheVersionOfTheFirmware) { EXPECT_EQ(printed({"--version"}), "ex9000-sim D01.00\n"); }

TEST(Arguments, OptionsThatOnlyPrintRejectOtherArguments) {
  expect_error({"EX9042D", "--version"}, "--version: only prints text", "leave out EX9042D");
  expect_error({"--models", "EX9042D"}, "--models: only prints text", "leave out EX9042D");
  expect_error({"--example", "--log"}, "--example: only prints text", "leave out --log");
  expect_error({"--example", "--seed", "abc"}, "--example: only prints text", "leave out --seed");
  expect_error({"--models", "--example"}, "--models: only prints text", "leave out --example");
  expect_error({"--schema", "EX9042D"}, "--schema: only prints text", "leave out EX9042D");
  expect_error({"--models", "play", "s.txt"}, "--models: only prints text", "leave out play");
  expect_error({"--example", "describe"}, "--example: only prints text", "leave out describe");
}

}  // namespace
}  // namespace ex9000::sim
