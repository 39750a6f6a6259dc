// Tests the control socket's commands for a single line, for one of several lines, for the module at a
// position, and for the whole program.
#include <gtest/gtest.h>

#include <string>

#include "sim/notation/actions.hpp"
#include "sim/notation/module_notation.hpp"
#include "tests/sim/front_ends/control_socket/control_bench.hpp"

namespace ex9000::sim {
namespace {

TEST(ControlLine, ListShowsEveryModuleWithItsPosition) {
  ThreeModules modules;
  const std::string text = modules.tell("list");
  EXPECT_TRUE(has(text, "1 EX9042D-M at 01")) << text;
  EXPECT_TRUE(has(text, "2 EX9052D at 02")) << text;
  EXPECT_TRUE(has(text, "3 EX9055D at 0A")) << text;
  modules.tell("2 power off");
  EXPECT_TRUE(has(modules.tell("list"), "2 EX9052D"));
}

TEST(ControlLine, APositionSelectsOnlyTheModuleAtThisPosition) {
  ThreeModules modules;
  EXPECT_EQ(modules.tell("3 input 0 on"), "ok");
  EXPECT_EQ(modules.at(2).input_levels(), 0);
  EXPECT_EQ(modules.at(3).input_levels(), 1);
  EXPECT_EQ(modules.tell("2 power off"), "ok");
  EXPECT_TRUE(modules.at(1).powered());
  EXPECT_FALSE(modules.at(2).powered());
  EXPECT_TRUE(modules.at(3).powered());
}

TEST(ControlLine, AnInvalidPositionIsRefused) {
  ThreeModules modules;
  for (const char* position : {"0", "00", "4", "10", "256", "4294967297", "18446744073709551617", "-1", "+1",
                               "1.", "0x1", "1st", "A", "#1", "**"}) {
    EXPECT_EQ(modules.tell(std::string(position) + " power off").rfind("error: ", 0), 0U) << position;
    for (const std::size_t module : {1U, 2U, 3U}) {
      EXPECT_TRUE(modules.at(module).powered()) << position;
    }
  }
}

TEST(ControlLine, TheCommandHelpAndTheOptionHelpShowTheseCommands) {
  ControlBench bench("EX9052D");
  const std::string text = bench.tell("help");
  for (const std::string form : {"N power on|off",
                                 "N reset",
                                 "N init on|off",
                                 "N input C on|off",
                                 "N pulse C [xCOUNT]",
                                 "N inputs",
                                 "N outputs",
                                 "N timers",
                                 "N filters",
                                 "N led",
                                 "N hang",
                                 "N status",
                                 "baud RATE",
                                 "format FORMAT",
                                 "sent",
                                 "fault FAULT...",
                                 "fault off K|all",
                                 "faults",
                                 "N fault FAULT...",
                                 "line NAME ...",
                                 "list",
                                 "help",
                                 "quit",
                                 "advance TIME [after N] [quiet]"}) {
    EXPECT_TRUE(has(" " + text + ",", " " + form + ",")) << form << " in " << text;
    EXPECT_TRUE(has("\n" + action_help(), "\n  " + form + (form.size() < 19 ? " " : "\n"))) << form;
  }
}

TEST(ControlLine, QuitIsAcknowledgedAndOnlyTheExactCommandQuits) {
  ModuleBench bench("EX9052D");
  Control control({{"", bench.line()}});
  const Control::Reply reply = control.carry_out("quit");
  EXPECT_EQ(reply.text, "ok");
  EXPECT_TRUE(reply.quit);
  for (const char* command : {"quit now", "1 quit", "Quit", "quitt", "qui", "quit quit"}) {
    const Control::Reply refused = control.carry_out(command);
    EXPECT_EQ(checked(refused).rfind("error: ", 0), 0U) << command;
    EXPECT_FALSE(refused.quit) << command;
  }
}

/// Two lines: `hall` with two modules, and `yard` with one module.
class TwoLines {
 public:
  TwoLines() {
    hall_.come_up();
    yard_.come_up();
  }

  std::string tell(const std::string& command) { return checked(control_.carry_out(command)); }
  Line& hall() { return hall_; }
  Line& yard() { return yard_; }

 private:
  Line hall_{{parse_module_spec("EX9042D@01"), parse_module_spec("EX9052D@02")},
             kPaced,
             [](std::uint8_t, ByteStatus) {}};
  Line yard_{{parse_module_spec("EX9055D@01")}, kPaced, [](std::uint8_t, ByteStatus) {}};
  Control control_{{{"hall", hall_}, {"yard", yard_}}};
};

TEST(ControlLines, ModulesAreNumberedAcrossAllLines) {
  TwoLines lines;
  EXPECT_EQ(lines.tell("list"),
            "ok 3 modules: 1 EX9042D at 01 on hall, 2 EX9052D at 02 on hall, 3 EX9055D at 01 on yard");
  EXPECT_EQ(lines.tell("3 input 0 on"), "ok");
  EXPECT_EQ(lines.yard().module(0).input_levels(), 1);
  EXPECT_EQ(lines.hall().module(1).input_levels(), 0);
  EXPECT_TRUE(has(lines.tell("4 power off"), "no module 4; expected a position from 1 to 3"));
}

TEST(ControlLines, AFaultBelongsToTheNamedLineOrToTheLineOfItsModule) {
  TwoLines lines;
  EXPECT_EQ(lines.tell("3 fault gone"), "ok 1");
  EXPECT_FALSE(lines.yard().module(0).powered());
  EXPECT_TRUE(lines.hall().module(0).powered());
  EXPECT_EQ(lines.tell("line hall fault gone"), "ok 1");
  EXPECT_FALSE(lines.hall().module(0).powered());
  EXPECT_FALSE(lines.hall().module(1).powered());
  EXPECT_EQ(lines.tell("line yard faults"), "ok 1 fault: 1* x1 3 gone");
  EXPECT_EQ(lines.tell("line hall faults"), "ok 1 fault: 1* x1 gone");
  EXPECT_EQ(lines.tell("line hall fault off 1"), "ok");
  EXPECT_TRUE(lines.hall().module(0).powered());
  EXPECT_FALSE(lines.yard().module(0).powered());
  EXPECT_EQ(lines.tell("line yard fault off all"), "ok");
  EXPECT_TRUE(lines.yard().module(0).powered());
}

TEST(ControlLine, BaudSetsTheRateOfTheMaster) {
  ControlBench bench("EX9052D");
  EXPECT_EQ(bench.tell("baud 19200"), "ok");
  EXPECT_EQ(bench.line().master().mode().baud, 19200U);
  for (const char* wrong : {"baud", "baud 0", "baud 9601", "baud fast", "baud 9600 now"}) {
    EXPECT_EQ(bench.tell(wrong).rfind("error: ", 0), 0U) << wrong;
    EXPECT_EQ(bench.line().master().mode().baud, 19200U) << wrong;
  }
}

TEST(ControlLine, FormatSetsTheLineFormatOfTheMaster) {
  ControlBench bench("EX9052D,format=8E1");
  EXPECT_EQ(bench.tell("format 8N1"), "ok");
  EXPECT_EQ(bench.ask("$01M"), "");
  EXPECT_EQ(bench.tell("format 8E1"), "ok");
  EXPECT_EQ(bench.ask("$01M"), "!019052");
  for (const char* wrong : {"format", "format 8", "format 7E1", "format even", "format 8E1 now"}) {
    EXPECT_EQ(bench.tell(wrong).rfind("error: ", 0), 0U) << wrong;
    EXPECT_EQ(bench.line().master().mode().format, LineFormat::k8E1) << wrong;
  }
}

TEST(ControlLine, RateAndFormatOfASerialPortCannotBeChanged) {
  ModuleBench bench("EX9052D");
  Control control({{"", bench.line(), nullptr, true}});
  EXPECT_EQ(control.carry_out("format 8E1").text,
            "error: the line's serial port keeps its rate and format; start the program with others");
  EXPECT_EQ(control.carry_out("baud 19200").text,
            "error: the line's serial port keeps its rate and format; start the program with others");
  EXPECT_EQ(bench.line().master().mode(), hal::SerialMode{9600});
}

TEST(ControlLine, TheCommandSentReportsHowManyBytesWereWrittenToEachPort) {
  ModuleBench bench("EX9052D");
  Control control({{"", bench.line(), [] { return 42U; }}});
  EXPECT_EQ(control.carry_out("sent").text, "ok 42");
  EXPECT_EQ(control.carry_out("sent now").text.rfind("error: ", 0), 0U);
}

TEST(ControlLine, AdvanceRequiresSteppedTime) {
  ControlBench bench("EX9052D");
  const VirtualTime now = bench.now();
  EXPECT_EQ(bench.tell("advance 1s"),
            "error: 'advance' requires --speed step; without it, the lines' time advances by itself");
  EXPECT_EQ(bench.now(), now);
}

TEST(ControlLines, BaudAndFormatApplyOnlyToTheNamedLine) {
  TwoLines lines;
  EXPECT_EQ(lines.tell("line yard baud 115200"), "ok");
  EXPECT_EQ(lines.yard().master().mode().baud, 115200U);
  EXPECT_EQ(lines.tell("line yard format 8O1"), "ok");
  EXPECT_EQ(lines.yard().master().mode().format, LineFormat::k8O1);
  EXPECT_EQ(lines.hall().master().mode().format, LineFormat::k8N1);
  EXPECT_EQ(lines.hall().master().mode().baud, 9600U);
}

TEST(ControlLines, CommandsForALineRequireItsNameIfThereAreSeveralLines) {
  TwoLines lines;
  for (const char* command : {"fault gone", "faults", "fault off all", "baud 9600", "format 8N1", "sent"}) {
    EXPECT_EQ(lines.tell(command), "error: there are several lines; put 'line NAME' before the command")
        << command;
  }
  EXPECT_EQ(lines.tell("line shed faults"), "error: no line 'shed'; expected one of hall, yard");
  EXPECT_TRUE(has(lines.tell("line hall"),
                  "expected line NAME and a command of a line, for example line NAME faults"));
  for (const char* command : {"line hall list", "line hall 1 power off", "line hall quit",
                              "line hall line hall faults", "line hall fault", "line hall fault off 1"}) {
    EXPECT_EQ(lines.tell(command).rfind("error: ", 0), 0U) << command;
  }
  EXPECT_TRUE(lines.hall().module(0).powered());
}

}  // namespace
}  // namespace ex9000::sim
