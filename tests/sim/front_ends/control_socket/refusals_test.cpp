// Tests that the control socket rejects invalid commands, that a rejected command changes nothing, and that
// additional blanks, tabs and a final carriage return have no effect.
#include <gtest/gtest.h>

#include <sstream>
#include <string>

#include "tests/sim/front_ends/control_socket/control_bench.hpp"

namespace ex9000::sim {
namespace {

/// Commands, each followed by `|`.
constexpr const char* kInvalid =
    "power|power off|off|1|1 power|1 power OFF|1 power 0|1 power off now|1 Power off|1 powerr off|1 "
    "power=off|"
    "1 reset now|1 init|1 init yes|1 input|1 input 0|1 input on|1 input 0 high|1 input 0 on off|1 input -1 "
    "on|"
    "1 input 0x0 on|1 input +0 on|1 input 99999999999999999999 on|1 input 4294967296 on|1 input 8 on|"
    "1 pulse|1 pulse 0 x1 1|1 pulse -1|1 pulse 8|1 pulse 0 x0|1 pulse 0 x00|1 pulse 0 x1000001|1 pulse 0 x-1|"
    "1 pulse 0 x4294967297|1 pulse 0 x18446744073709551617|1 pulse 0 x0x10|1 pulse 0 x1e3|1 pulse 0 x1.0|"
    "1 inputs 0|1 outputs 0|1 led on|1 hang on|1 status all|list 1|help me|1 1 power off|1 list|1 help|LIST|"
    "bogus|$01M|1 power off; 1 power off|'1' power off|1,power,off|sent now|quit now|1 quit|Quit|quitt|"
    "0 power off|00 power off|4 power off|256 power off|4294967297 power off|18446744073709551617 power off|"
    "-1 power off|+1 power off|1. power off|0x1 power off|1st power off|A power off|** power off|"
    "baud|baud 0|baud 9601|baud fast|baud 9600 now|format|format 8|format 7E1|format even|format 8E1 now|"
    "fault|1 fault|fault off|fault off 1|fault off 0|fault off -1|fault off 1 2|fault off all all|faults 1|"
    "fault off ALL|fault off 99999999999999999999|1 faults|1 fault off 1|2 fault gone|0 fault gone|"
    "fault bogus|fault gone at noon|fault gone every 1s|fault gone at 1ms|1 fault echo 2ms|faultgone|"
    "line|line x|line x fault|line x fault gone|";

TEST(ControlRefusals, InvalidCommandsAreRefused) {
  ControlBench bench("EX9055D");
  for (const char* blank : {"", " ", "\t \t", "\r"}) {
    bench.expect_refused(blank);
  }
  std::istringstream commands(kInvalid);
  for (std::string command; std::getline(commands, command, '|');) {
    bench.expect_refused(command);
  }
}

TEST(ControlRefusals, TheRefusalOfBinaryBytesOrOfAVeryLongCommandIsOneLine) {
  ControlBench bench("EX9055D");
  using namespace std::string_literals;
  for (const std::string& command :
       {"\0"s, "1 power off\0"s, "1\0power off"s, "1 \0 power off"s, "1 power \0off"s,
        "\xEF\xBB\xBF"
        "1 reset"s,
        "1\xC2\xA0reset"s, "\xFF\xFE\xFF"s, "1 power \xC3\xA4"s, "1 input \xD9\xA1 on"s, "1 reset\x85"s,
        "1 reset\x7F"s, "\x1B[2J"s, "1 reset\x08"s, std::string(100'000, 'x'), std::string(100'000, '1')}) {
    bench.expect_refused(command);
  }
}

TEST(ControlForm, AdditionalBlanksTabsAndACarriageReturnAreIgnored) {
  ControlBench bench("EX9055D");
  for (const std::string& command :
       {std::string("1 input 2 on\r"), std::string("   1   input\t\t2   on   "),
        std::string("\t1\tinput\t2\ton\t"),
        "1" + std::string(500, ' ') + "input 2" + std::string(500, ' ') + "on \r"}) {
    bench.tell("1 input 2 off");
    EXPECT_EQ(bench.tell(command), "ok") << command;
    EXPECT_EQ(bench.number("1 inputs"), 4U) << command;
  }
  EXPECT_EQ(bench.tell("list\r"), bench.tell("list"));
  EXPECT_EQ(bench.tell("1 led\r"), "ok on");
}

}  // namespace
}  // namespace ex9000::sim
