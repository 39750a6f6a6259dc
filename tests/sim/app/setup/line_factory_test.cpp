// Tests lines that are created from a setup: their input programs, their faults and the transmission
// time of a byte.
#include "sim/app/setup/line_factory.hpp"
#include "sim/notation/fault_notation.hpp"
#include "sim/notation/input_notation.hpp"
#include "sim/notation/module_notation.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace ex9000::sim {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

class MadeLine : public testing::Test {
 protected:
  /// Creates a line of two modules, starts its input programs and adds its faults. The line's time is then
  /// 100 ms.
  void begin() {
    setup_.modules = {parse_module_spec("EX9055D@01"), parse_module_spec("EX9055D@02")};
    const Model& model = *find_model("EX9055D");
    setup_.modules[0].inputs = {parse_input_program("3 square 2ms", model)};
    setup_.modules[1].inputs = {parse_input_program("4 square 2ms", model)};
    line_ = make_line(setup_, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
    line_->come_up();
    line_->configure_faults(1, [this](const std::string& text) { notices_.push_back(text); });
    begin_programs(*line_, setup_);
  }

  LineSetup setup_;
  std::unique_ptr<Line> line_;
  std::vector<std::string> notices_;
};

TEST_F(MadeLine, TheInputProgramOfEachModuleRuns) {
  begin();
  line_->wires().run_for(microseconds(500));
  EXPECT_EQ(line_->module(0).input_levels(), 1U << 3U);
  EXPECT_EQ(line_->module(1).input_levels(), 1U << 4U);
}

TEST_F(MadeLine, AFaultWhoseTimePassesDuringTheStartOfTheModulesBeginsImmediately) {
  setup_.faults = {parse_fault("gone at 20ms"), parse_fault("gone at 200ms")};
  setup_.faults[0].module = 0;
  setup_.faults[1].module = 1;
  begin();
  line_->wires().run_for(milliseconds(1));
  EXPECT_EQ(notices_.size(), 1U);
  line_->wires().run_for(milliseconds(100));
  EXPECT_EQ(notices_.size(), 2U);
}

TEST_F(MadeLine, AFaultThatRecursKeepsItsPeriod) {
  setup_.faults = {parse_fault("gone every 20ms for 1ms")};
  setup_.faults[0].module = 0;
  begin();
  line_->wires().run_for(milliseconds(90));
  EXPECT_EQ(notices_.size(), 8U);  // four beginnings and four ends
}

TEST_F(MadeLine, AByteTakesTenBitTimesWithAndWithoutStrictGaps) {
  for (const bool strict : {false, true}) {
    setup_.strict_gaps = strict;
    begin();
    constexpr std::uint8_t kByte = 0x55;
    line_->master().send(&kByte, 1);
    line_->wires().run_for(microseconds(1041));  // ten bits at 9600 baud take 1041.7 us
    EXPECT_TRUE(line_->wires().carries()) << strict;
    line_->wires().run_for(microseconds(1));
    EXPECT_FALSE(line_->wires().carries()) << strict;
  }
}

}  // namespace
}  // namespace ex9000::sim
