// Tests the stations that change the level of a module's input.
#include "sim/virtual_line/line/input_program.hpp"

#include <gtest/gtest.h>

#include <string>
#include <utility>
#include <vector>

#include "sim/notation/input_notation.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/virtual_line/line/line.hpp"

namespace ex9000::sim {
namespace {

using namespace std::chrono_literals;

/// The times at which the level of an input changes, and the new levels.
using Moves = std::vector<std::pair<VirtualTime, bool>>;

/// A module, and a program that changes the level of one input of this module. The program starts when the
/// line's time is 100 ms.
class InputBench {
 public:
  explicit InputBench(const std::string& program, const std::string& edge = "falling", std::uint64_t seed = 1)
      : program_(parse_input_program(program, model_called("EX9052D"))),
        line_({parse_module_spec("EX9052D,edge=" + edge)}, kPaced, [](std::uint8_t, ByteStatus) {}) {
    line_.come_up();
    line_.configure_faults(seed, [](const std::string&) {});
    line_.move_input(0, program_);
  }

  void run_until(VirtualTime time) { line_.wires().run_until(time); }
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
    while (line_.wires().next() <= time) {
      line_.wires().run_until(line_.wires().next());
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
