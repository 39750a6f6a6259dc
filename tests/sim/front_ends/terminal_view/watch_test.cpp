// Tests the view of modules. In a terminal, the program repaints the view in place. Without a terminal, the
// program prints one line for each change.
#include "sim/front_ends/terminal_view/watch.hpp"
#include "sim/notation/module_notation.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace ex9000::sim {
namespace {

using Prints = std::vector<std::string>;

constexpr const char* kRelays = "1  EX9067D     9067    01 DCON 9600 8N1          LED * on       power on";
constexpr const char* kLabels = "   RL      1  2  3  4  5  6  7";
constexpr const char* kAllOff = "           -  -  -  -  -  -  -";
constexpr const char* kRest = "   power-on 0000, safe 0000\n   host watchdog off";

class FakeTerminal final : public Terminal {
 public:
  [[nodiscard]] Screen screen() const override { return shape; }
  void write(const std::string& text) override { written.push_back(text); }
  bool keeps_up() override { return takes; }

  Screen shape;
  bool takes = true;
  Prints written;
};

class WatchTest : public ::testing::Test {
 protected:
  void watch(const std::vector<std::string>& modules, const std::string& name = "") {
    std::vector<ModuleSpec> specs;
    for (const std::string& module : modules) {
      specs.push_back(parse_module_spec(module));
    }
    lines_.push_back(
        std::make_unique<Line>(specs, kPaced, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {}));
    Line& line = *lines_.back();
    line.come_up();
    watch_->add_line(name, line, [&line] { return line.clock().virtual_now(); });
  }
  void without_a_terminal() {
    watch_.emplace(nullptr, [this](const std::string& text) { terminal_.written.push_back(text); });
  }
  SimulatedModule& module(std::size_t index = 0) { return lines_[0]->module(index); }
  Prints looked() {
    terminal_.written.clear();
    watch_->look();
    return terminal_.written;
  }
  Prints printed(const std::string& line) {
    terminal_.written.clear();
    watch_->print(line);
    return terminal_.written;
  }

  FakeTerminal terminal_;
  std::optional<Watch> watch_{std::in_place, &terminal_, [](const std::string& /*text*/) { FAIL(); }};
  std::vector<std::unique_ptr<Line>> lines_;
};

std::string relays(const std::string& lamps) {
  return std::string(kRelays) + "\n" + kLabels + "\n" + lamps + "\n" + kRest + "\n";
}

TEST_F(WatchTest, PaintsModulesAndRepaintsThemInPlaceAfterAChange) {
  watch({"EX9067D"});
  EXPECT_EQ(looked(), Prints{relays(kAllOff)});
  EXPECT_EQ(looked(), Prints{});
  module().power(false);
  // The control sequences move the cursor up five lines and to the first column, and erase the screen from
  // there to the end.
  EXPECT_EQ(
      looked(),
      (Prints{"\x1b[5F\x1b[J1  EX9067D     9067                              LED - off      power off\n" +
              std::string(kLabels) + "\n" + kAllOff + "\n   power-on 0000, safe 0000\n"}));
  module().power(true);
  EXPECT_EQ(looked()[0].substr(0, 7), "\x1b[4F\x1b[J");
}

TEST_F(WatchTest, PrintsOtherTextAboveTheModules) {
  watch({"EX9067D"});
  EXPECT_EQ(printed("a greeting"), Prints{"a greeting\n"});
  looked();
  EXPECT_EQ(printed("a line of the log"), Prints{"\x1b[5F\x1b[Ja line of the log\n" + relays(kAllOff)});
}

TEST_F(WatchTest, HasRoundLampsOnAUtf8Terminal) {
  terminal_.shape.utf8 = true;
  watch({"EX9067D"});
  EXPECT_NE(looked()[0].find("●"), std::string::npos);
  EXPECT_NE(terminal_.written[0].find("○  ○  ○  ○  ○  ○  ○"), std::string::npos);
}

TEST_F(WatchTest, LeavesOutModulesThatDoNotFitTheTerminal) {
  const std::string left_out = " more modules are not shown; the terminal has too few rows";
  watch({"EX9067D", "EX9067D@02", "EX9067D@03", "EX9067D@04"});
  terminal_.shape.rows = 21;  // five lines for each module, and one for the cursor
  EXPECT_EQ(looked()[0].find(left_out), std::string::npos);
  terminal_.shape.rows = 20;
  EXPECT_NE(looked()[0].find("\n1 more module is not shown; the terminal has too few rows"),
            std::string::npos);
  terminal_.shape.rows = 12;  // two modules, the line about the others, and the cursor
  const std::string two = looked()[0];
  EXPECT_NE(two.find("\n2  EX9067D"), std::string::npos);
  EXPECT_EQ(two.find("\n3  EX9067D"), std::string::npos);
  EXPECT_NE(two.find("\n2" + left_out), std::string::npos);
  terminal_.shape.rows = 11;
  EXPECT_NE(looked()[0].find("\n3" + left_out), std::string::npos);
  terminal_.shape.rows = 1;
  EXPECT_EQ(looked()[0], "\x1b[H\x1b[J4" + left_out + "\n");
}

TEST_F(WatchTest, ShortensLinesToTheTerminalWidth) {
  terminal_.shape.columns = 9;
  terminal_.shape.utf8 = true;
  watch({"EX9067D"});
  module().power(false);
  EXPECT_EQ(looked()[0], "1  EX9067\n   RL    \n         \n   power-\n");
  terminal_.shape.columns = 12;
  EXPECT_NE(looked()[0].find("\n           ○\n"), std::string::npos);
}

TEST_F(WatchTest, RepaintsEverythingAfterAChangeOfTheTerminalSize) {
  watch({"EX9067D"});
  looked();
  terminal_.shape.columns = 100;
  EXPECT_EQ(looked(), Prints{"\x1b[H\x1b[J" + relays(kAllOff)});
}

TEST_F(WatchTest, DoesNotRepaintUntilTheTerminalHasAcceptedEarlierOutput) {
  watch({"EX9067D"});
  looked();
  terminal_.takes = false;
  module().power(false);
  EXPECT_EQ(looked(), Prints{});
  module().power(true);
  module().set_init(true);
  terminal_.takes = true;
  EXPECT_NE(looked()[0].find("power on, INIT*"), std::string::npos);  // shows the present state
}

TEST_F(WatchTest, ShowsTheNameOfEachBusLine) {
  watch({"EX9067D", "EX9067D@02"}, "hall");
  watch({"EX9067D@03"}, "yard");
  const std::string text = looked()[0];
  EXPECT_EQ(text.rfind("--- hall\n1  EX9067D", 0), 0U);
  EXPECT_NE(text.find("\n2  EX9067D"), std::string::npos);
  EXPECT_NE(text.find("\n--- yard\n3  EX9067D"), std::string::npos);
}

TEST_F(WatchTest, ReportsChangesIfThereIsNoTerminal) {
  without_a_terminal();
  watch({"EX9067D", "EX9052D@02"});
  looked();
  ASSERT_GT(terminal_.written.size(), 2U);
  EXPECT_EQ(terminal_.written[0], "    0.100000  - 1 EX9067D: power on");
  EXPECT_EQ(looked(), Prints{});
  lines_[0]->bus().run_for(std::chrono::milliseconds(400));
  module(1).set_input(3, true);
  EXPECT_EQ(looked(), (Prints{"    0.500000  - 2 EX9052D: inputs 08",
                              "    0.500000  - 2 EX9052D: latched high 08, low 00"}));
  EXPECT_EQ(printed("a line of the log"), Prints{"a line of the log"});
}

}  // namespace
}  // namespace ex9000::sim
