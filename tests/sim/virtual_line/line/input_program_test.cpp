// Tests the programs that change the level of a module's input.
#include "sim/virtual_line/line/input_program.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "sim/virtual_line/line/line.hpp"
#include "tests/support/refusal.hpp"

namespace ex9000::sim {
namespace {

using namespace std::chrono_literals;
using Kind = InputProgram::Kind;

InputProgram parsed(const std::string& text) { return parse_input_program(text, model_called("EX9052D")); }

/// The times at which the level of an input changes, and the new levels.
using Moves = std::vector<std::pair<VirtualTime, bool>>;

/// A module, and a program that changes the level of one input of this module. The program starts when the
/// line's time is 100 ms.
class InputBench {
 public:
  explicit InputBench(const std::string& program, const std::string& edge = "falling", std::uint64_t seed = 1)
      : program_(parsed(program)),
        line_({parse_module_spec("EX9052D,edge=" + edge)}, kPaced, [](std::uint8_t, ByteStatus) {}) {
    line_.come_up();
    line_.configure_faults(seed, [](const std::string&) {});
    line_.move_input(0, program_);
  }

  void run_until(VirtualTime time) { line_.bus().run_until(time); }
  [[nodiscard]] bool level() { return (module().input_levels() >> program_.channel & 1U) != 0; }
  [[nodiscard]] std::uint32_t counter() {
    module().set_init(false);  // runs the main loop, which adds the edges to the counter
    return module().module().state().inputs.counter(program_.channel);
  }
  SimulatedModule& module() { return line_.module(0); }
  /// Processes all events up to and including `time`, and returns the changes of the level.
  Moves moves_until(VirtualTime time) {
    Moves moves;
    bool was = level();
    while (line_.bus().next() <= time) {
      line_.bus().run_until(line_.bus().next());
      if (level() != was) {
        was = level();
        moves.emplace_back(line_.clock().virtual_now(), was);
      }
    }
    return moves;
  }

 private:
  InputProgram program_;
  Line line_;
};

// --- syntax ---

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
           {"0", "''", "square PERIOD"},
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

// --- movements ---

TEST(MovedInput, ASquareWaveHasAnExactPeriodAndEachPulseIsCounted) {
  for (const std::string edge : {"falling", "rising"}) {
    InputBench bench("5 square 7ms for 3ms", edge);
    for (int i = 0; i < 1000; ++i) {
      const VirtualTime begins = 100ms + i * 7ms;
      if (i != 0) {
        bench.run_until(begins - 1ns);
        ASSERT_FALSE(bench.level()) << i;
      }
      bench.run_until(begins);
      ASSERT_TRUE(bench.level()) << i;
      bench.run_until(begins + 3ms - 1ns);
      ASSERT_TRUE(bench.level()) << i;
      bench.run_until(begins + 3ms);
      ASSERT_FALSE(bench.level()) << i;
    }
    EXPECT_EQ(bench.counter(), 1000U) << edge;
  }
}

TEST(MovedInput, AKeyThatIsPressedOnceTurnsTheInputOnOnlyOnce) {
  InputBench bench("0 key at 2s for 300ms");
  EXPECT_EQ(bench.moves_until(1h), (Moves{{2s, true}, {2300ms, false}}));
  EXPECT_EQ(bench.counter(), 1U);
}

TEST(MovedInput, AKeyWhoseTimeHasPassedIsPressedImmediately) {
  InputBench bench("0 key at 1ms for 300ms");
  EXPECT_EQ(bench.moves_until(1s), (Moves{{100ms, true}, {400ms, false}}));
}

TEST(MovedInput, APeriodicKeyIsFirstPressedAfterOnePeriod) {
  InputBench bench("0 key every 10s for 300ms");
  EXPECT_EQ(bench.moves_until(31s), (Moves{{10'100ms, true},
                                           {10'400ms, false},
                                           {20'100ms, true},
                                           {20'400ms, false},
                                           {30'100ms, true},
                                           {30'400ms, false}}));
}

TEST(MovedInput, BouncingContactsChangeSeveralTimesAndThenSettle) {
  InputBench bench("0 key at 1s for 300ms bounce 5ms", "rising");
  const Moves moves = bench.moves_until(10s);
  std::size_t making = 0;
  for (std::size_t i = 0; i < moves.size(); ++i) {
    const VirtualTime at = moves[i].first;
    const bool makes = at < 1300ms;
    making += makes ? 1 : 0;
    EXPECT_EQ(moves[i].second, i % 2 == 0);  // each move changes the level
    EXPECT_TRUE(makes ? at >= 1s && at < 1005ms : at >= 1300ms && at < 1305ms) << at.count();
  }
  EXPECT_EQ(moves.front().first, 1s);
  EXPECT_GE(making, 3U);
  EXPECT_EQ(making % 2, 1U);                   // after the bouncing, the input is on
  EXPECT_EQ((moves.size() - making) % 2, 1U);  // after the release and its bouncing, the input is off
  EXPECT_GE(moves.size() - making, 3U);
  EXPECT_EQ(bench.counter(), moves.size() / 2);
  EXPECT_FALSE(bench.level());
}

TEST(MovedInput, AnInputBouncesEquallyWithEqualSeedsAndDifferentlyWithOtherSeeds) {
  const auto moves = [](std::uint64_t seed) {
    return InputBench("0 square 50ms bounce 5ms", "falling", seed).moves_until(1s);
  };
  EXPECT_EQ(moves(1), moves(1));
  EXPECT_NE(moves(1), moves(2));
}

TEST(MovedInput, AnInputChangesWithoutSupplyButItsEdgesAreNotCounted) {
  InputBench bench("0 square 100ms");
  bench.run_until(1s);
  bench.module().power(false);
  bench.run_until(1125ms);
  EXPECT_TRUE(bench.level());
  bench.module().power(true);
  bench.run_until(1175ms);
  EXPECT_FALSE(bench.level());
  bench.run_until(1275ms);
  EXPECT_EQ(bench.counter(), 2U);  // the falling edges at 1150 and 1250 ms
}

}  // namespace
}  // namespace ex9000::sim
