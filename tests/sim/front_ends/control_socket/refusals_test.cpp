// Tests that the control socket rejects invalid commands, that a rejected command changes nothing, and that
// additional blanks, tabs and a final carriage return have no effect.
#include <gtest/gtest.h>

#include <string>

#include "tests/sim/front_ends/control_socket/control_bench.hpp"

namespace ex9000::sim {
namespace {

TEST(ControlRefusals, InvalidCommandsAreRefused) {
  ControlBench bench("EX9055D");
  for (const char* command : {"",
                              " ",
                              "\t \t",
                              "\r",
                              "1",
                              "power",
                              "power off",
                              "off",
                              "1 power",
                              "1 power OFF",
                              "1 power 0",
                              "1 power off now",
                              "1 Power off",
                              "1 powerr off",
                              "1 power=off",
                              "1 reset now",
                              "1 init",
                              "1 init yes",
                              "1 input",
                              "1 input 0",
                              "1 input on",
                              "1 input 0 high",
                              "1 input 0 on off",
                              "1 input -1 on",
                              "1 input 0x0 on",
                              "1 input +0 on",
                              "1 input 99999999999999999999 on",
                              "1 input 4294967296 on",
                              "1 pulse",
                              "1 pulse 0 x1 1",
                              "1 pulse -1",
                              "1 inputs 0",
                              "1 outputs 0",
                              "1 led on",
                              "1 hang on",
                              "1 status all",
                              "list 1",
                              "help me",
                              "1 1 power off",
                              "1 list",
                              "1 help",
                              "LIST",
                              "bogus",
                              "$01M",
                              "1 power off; 1 power off",
                              "'1' power off",
                              "1,power,off"}) {
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
