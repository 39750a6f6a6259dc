// Tests the syntax of the programs that change the level of a module's input.
#include "sim/notation/input_notation.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/notation/module_notation.hpp"
#include "tests/support/refusal.hpp"

namespace ex9000::sim {
namespace {

using namespace std::chrono_literals;
using Kind = InputProgram::Kind;

InputProgram parsed(const std::string& text) { return parse_input_program(text, model_called("EX9052D")); }

TEST(InputProgram, ASquareWaveIsOnForHalfOfItsPeriodByDefault) {
  const InputProgram half = parsed("0 square 100ms");
  EXPECT_EQ(half.channel, 0U);
  EXPECT_EQ(half.kind, Kind::Square);
  EXPECT_EQ(half.time, 100ms);
  EXPECT_EQ(half.high, 50ms);
  EXPECT_EQ(half.bounce, 0ms);
  EXPECT_EQ(parsed("7 square 100ms for 10ms bounce 2ms").high, 10ms);
  EXPECT_EQ(parsed("7 square 100ms bounce 2ms for 10ms").bounce, 2ms);
}

TEST(InputProgram, AKeyIsPressedOnceOrPeriodically) {
  const InputProgram once = parsed("3 key at 2s for 300ms");
  EXPECT_EQ(once.channel, 3U);
  EXPECT_EQ(once.kind, Kind::KeyOnce);
  EXPECT_EQ(once.time, 2s);
  EXPECT_EQ(once.high, 300ms);
  const InputProgram again = parsed("3 key every 10s for 300ms bounce 5ms");
  EXPECT_EQ(again.kind, Kind::KeyAgain);
  EXPECT_EQ(again.time, 10s);
  EXPECT_EQ(again.bounce, 5ms);
  EXPECT_EQ(parsed("3 key at 1s for 300ms bounce 10us").bounce, 10us);
}

TEST(InputProgram, AnInvalidProgramIsRefusedWithTheErrorAndTheCorrection) {
  struct Refused {
    const char* text;
    const char* names;
    const char* mend;
  };
  for (const Refused& wrong : std::vector<Refused>{
           {"", "the channel is missing", "expected 'CHANNEL square PERIOD'"},
           {"8 square 1s", "no input '8'", "0 to 7"},
           {"-1 square 1s", "no input '-1'", "0 to 7"},
           {"0x1 square 1s", "no input '0x1'", "0 to 7"},
           {"0", "ends too early", "square PERIOD"},
           {"0 sine 1s", "'sine'", "square PERIOD"},
           {"0 square", "expected a period", "after 'square'"},
           {"0 square 1", "'1': expected a duration", "12.5s"},
           {"0 square 1s at 2s", "'at': expected 'for TIME'", "or 'bounce TIME'"},
           {"0 square 1s for", "expected a duration", "after 'for'"},
           {"0 square 1s for 1ms for 1ms", "'for' is given twice", "leave out one of them"},
           {"0 square 10us", "expected the input to be on", "at least 10us"},
           {"0 square 1s for 1s", "the period is too short", "at least 10us longer than it bounces"},
           {"0 square 1s for 999.991ms", "the period is too short", "at least 10us longer than it bounces"},
           {"0 square 1s bounce 600ms", "expected the input to be on", "at least as long as the bounce"},
           {"0 square 1s bounce 5us", "expected a bounce", "at least 10us"},
           {"0 key", "a key is incomplete", "'at TIME'"},
           {"0 key at 1s", "a key is incomplete", "'for TIME'"},
           {"0 key for 1s", "a key is incomplete", "'every TIME'"},
           {"0 key at 1s every 2s for 1ms", "'at' and 'every' cannot be combined", "leave out one of them"},
           {"0 key at 1s for 1ms loud 1s", "'loud': expected 'at TIME'", "'bounce TIME'"},
           {"0 key every 1s for 1s", "the period is too short", "at least 10us longer than it bounces"},
       }) {
    const std::string why = refusal([&] { parsed(wrong.text); });
    EXPECT_EQ(why.rfind(wrong.text, 0), 0U) << why;
    EXPECT_NE(why.find(wrong.names), std::string::npos) << why;
    EXPECT_NE(why.find(wrong.mend), std::string::npos) << why;
    EXPECT_EQ(why.find('\n'), std::string::npos) << why;
  }
  EXPECT_EQ(refusal([] { parse_input_program("0 square 1s", model_called("EX9042D")); }),
            "0 square 1s: the EX9042D has no input '0'; it has none");
}

}  // namespace
}  // namespace ex9000::sim
