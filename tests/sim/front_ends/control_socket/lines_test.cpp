// Tests the control socket's commands for a single line, for one of several lines, for the module at a
// position, and for the whole program.
#include <gtest/gtest.h>

#include <string>

#include "sim/notation/module_notation.hpp"
#include "tests/sim/front_ends/control_socket/control_bench.hpp"

namespace ex9000::sim {
namespace {

TEST(ControlLine, HelpListsTheCommandsAndQuitIsAcknowledged) {
  ModuleBench bench("EX9052D");
  Control control({{"", bench.line()}});
  const std::string help = control.carry_out("help").text;
  for (const char* form : {"N power on|off,", "N pulse C [xCOUNT],", "fault off K|all,", "line NAME ...,"}) {
    EXPECT_TRUE(has(help, form)) << help;
  }
  EXPECT_TRUE(has(control.carry_out("line hall faults").text, "no line 'hall'; the only line has no name"));
  const Control::Reply reply = control.carry_out("quit");
  EXPECT_EQ(reply.text, "ok");
  EXPECT_TRUE(reply.quit);
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
  EXPECT_EQ(lines.tell("2 fault   power-cut \t after 3 writes"), "ok 2");
  EXPECT_EQ(lines.tell("line hall fault lost-reply every 10th reply"), "ok 3");
  EXPECT_EQ(lines.tell("line hall faults"),
            "ok 2 faults: 2 x0 2 power-cut after 3 writes; 3 x0 lost-reply every 10th reply");
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
}

TEST(ControlLine, AdvanceRequiresSteppedTime) {
  ControlBench bench("EX9052D");
  const VirtualTime now = bench.now();
  EXPECT_EQ(bench.tell("advance 1s"),
            "error: 'advance' requires --speed step; without it, the lines' time advances by itself");
  EXPECT_EQ(bench.now(), now);
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
