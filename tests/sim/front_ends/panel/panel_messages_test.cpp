// Tests the messages to a page of the panel. The first message contains the whole state, and later messages
// contain only the changes. Each message contains a limited number of frames. Also tests the commands of a
// page.
#include <gtest/gtest.h>

#include <chrono>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "sim/notation/module_notation.hpp"
#include "tests/sim/front_ends/panel/panel_bench.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::milliseconds;

TEST(PanelMessages, TheFirstMessageHasTheCompleteState) {
  PanelBench bench("EX9055D@07,name=PUMPS");
  const Message message = bench.look();
  const Message& hello = message["hello"];
  EXPECT_EQ(hello["version"], kFirmwareVersion);
  EXPECT_EQ(hello["run"].get<std::string>().size(), 16U);
  EXPECT_EQ(hello["usualFaults"][0], "bit-errors 1e-4");
  EXPECT_EQ(hello["lines"][0]["name"], "hall");
  EXPECT_EQ(hello["lines"][0]["ports"][0], "127.0.0.1:5020");
  EXPECT_EQ(hello["modules"][0]["model"], "EX9055D");
  EXPECT_EQ(hello["modules"][0]["outputs"][7], "DO7");
  EXPECT_EQ(hello["modules"][0]["inputs"].size(), 8U);
  const Message& module = message["state"]["modules"][0];
  for (const char* part : {"plate", "records", "hostWatchdog", "stored"}) {
    EXPECT_TRUE(module.contains(part)) << part;
  }
  EXPECT_EQ(module["plate"]["address"], 7);
  EXPECT_EQ(module["stored"]["settings"]["name"], "PUMPS");
}

TEST(PanelMessages, LaterMessagesHaveOnlyTheChanges) {
  PanelBench bench("EX9055D");
  static_cast<void>(bench.look());
  EXPECT_TRUE(bench.look().is_null());
  bench.module().set_input(2, true);
  const Message message = bench.look();
  EXPECT_FALSE(message.contains("hello"));
  const Message& module = message["state"]["modules"][0];
  EXPECT_EQ(module["plate"]["inputs"], 4);
  EXPECT_FALSE(module.contains("stored"));
  EXPECT_FALSE(module.contains("hostWatchdog"));
  EXPECT_TRUE(bench.look().is_null());
}

TEST(PanelMessages, APageThatReadsLateGetsTheCurrentState) {
  PanelBench bench("EX9055D");
  const auto slow = bench.panel().viewer();
  static_cast<void>(bench.look(*slow));
  for (int i = 1; i <= 5; ++i) {
    bench.module().set_input(0, i % 2 == 1);
    static_cast<void>(bench.look());
  }
  const Message message = bench.look(*slow);
  EXPECT_EQ(message["state"]["modules"].size(), 1U);
  EXPECT_EQ(message["state"]["modules"][0]["plate"]["inputs"], 1);
  EXPECT_TRUE(bench.look(*slow).is_null());
}

TEST(PanelMessages, APageGetsTheTimeAfterOneSecondWithoutAMessage) {
  PanelBench bench("EX9055D");
  static_cast<void>(bench.look());
  bench.pass_wall_time(milliseconds(999));
  EXPECT_TRUE(bench.look().is_null());
  bench.run(milliseconds(7));
  bench.pass_wall_time(milliseconds(1));
  const Message message = bench.look();
  const auto now = std::chrono::duration_cast<std::chrono::microseconds>(bench.now()).count();
  EXPECT_EQ(message, (Message{{"state", {{"lines", {{{"now", now}}}}, {"modules", Message::array()}}}}));
  EXPECT_TRUE(bench.look().is_null());
  bench.pass_wall_time(milliseconds(500));
  bench.module().set_input(0, true);
  EXPECT_FALSE(bench.look().is_null());
  bench.pass_wall_time(milliseconds(999));
  EXPECT_TRUE(bench.look().is_null()) << "the wait of one second begins at the last message";
}

/// Two lines with two modules each. The modules of both lines are numbered consecutively.
class TwoLines {
 public:
  TwoLines() {
    for (std::size_t i = 0; i < lines_.size(); ++i) {
      lines_[i]->come_up();
      LineSummary summary;
      summary.name = i == 0 ? "hall" : "yard";
      panel_.add_line(
          panel_line(summary, *lines_[i], [this, i] { return lines_[i]->clock().virtual_now(); }));
    }
    viewer_ = panel_.viewer();
    hello_ = look()["hello"];
  }

  Line& line(std::size_t index) { return *lines_[index]; }
  Panel& panel() { return panel_; }
  [[nodiscard]] const Message& hello() const { return hello_; }
  Message look() {
    panel_.look();
    const std::string text = viewer_->next();
    return text.empty() ? Message() : Message::parse(text);
  }
  void tell(const std::string& command) {
    const std::string reply = control_.carry_out(command).text;
    EXPECT_EQ(reply.rfind("ok", 0), 0U) << command << ": " << reply;
  }

 private:
  static std::unique_ptr<Line> make_line(const char* first, const char* second) {
    const std::vector<ModuleSpec> modules{parse_module_spec(first), parse_module_spec(second)};
    return std::make_unique<Line>(modules, kPaced, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {});
  }

  std::vector<std::unique_ptr<Line>> make_lines() {
    std::vector<std::unique_ptr<Line>> lines;
    lines.push_back(make_line("EX9042D@01", "EX9052D@02"));
    lines.push_back(make_line("EX9043D@01", "EX9055D@02"));
    return lines;
  }

  std::vector<std::unique_ptr<Line>> lines_ = make_lines();
  Control control_{{{"hall", *lines_[0]}, {"yard", *lines_[1]}}};
  Panel panel_{[this](const std::string& command) { return control_.carry_out(command); },
               [](std::size_t /*line*/, const RequestQueue::Request& /*request*/) {}, 1,
               [] { return std::chrono::steady_clock::time_point(); }};
  std::unique_ptr<PanelViewer> viewer_;
  Message hello_;
};

TEST(PanelOfTwoLines, EachModuleIsListedWithItsLine) {
  const TwoLines bench;
  const Message& modules = bench.hello()["modules"];
  ASSERT_EQ(modules.size(), 4U);
  const std::vector<std::pair<std::string, int>> expected{
      {"EX9042D", 0}, {"EX9052D", 0}, {"EX9043D", 1}, {"EX9055D", 1}};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(modules[i]["model"], expected[i].first) << i;
    EXPECT_EQ(modules[i]["line"], expected[i].second) << i;
  }
  EXPECT_EQ(bench.hello()["lines"][0]["name"], "hall");
  EXPECT_EQ(bench.hello()["lines"][1]["name"], "yard");
}

TEST(PanelOfTwoLines, AFaultIsReportedWithItsModuleAndLine) {
  const std::vector<std::pair<std::string, Message>> faults{{"1 fault late-reply 50ms", 0},
                                                            {"2 fault late-reply 50ms", 1},
                                                            {"3 fault late-reply 50ms", 2},
                                                            {"4 fault late-reply 50ms", 3},
                                                            {"line yard fault bit-errors 0.001", Message()},
                                                            {"line hall fault bit-errors 0.001", Message()}};
  for (const auto& [command, module] : faults) {
    SCOPED_TRACE(command);
    TwoLines bench;
    bench.tell(command);
    const std::size_t line = command[0] == '3' || command[0] == '4' || command[5] == 'y' ? 1 : 0;
    const Message lines = bench.look()["state"]["lines"];
    ASSERT_EQ(lines[line]["faults"].size(), 1U);
    EXPECT_EQ(lines[line]["faults"][0]["module"], module);
    EXPECT_FALSE(lines[1 - line].contains("faults"));
  }
}

TEST(PanelOfTwoLines, AChangeIsReportedWithItsModule) {
  TwoLines bench;
  bench.line(1).module(1).set_input(5, true);
  const Message modules = bench.look()["state"]["modules"];
  ASSERT_EQ(modules.size(), 1U);
  EXPECT_EQ(modules[0]["module"], 3);
  EXPECT_EQ(modules[0]["plate"]["inputs"], 1U << 5U);
  bench.line(0).module(1).set_input(0, true);
  EXPECT_EQ(bench.look()["state"]["modules"][0]["module"], 1);
}

TEST(PanelOfTwoLines, EachLineHasItsOwnTime) {
  TwoLines bench;
  bench.line(1).wires().run_for(milliseconds(250));
  bench.line(1).module(1).set_input(5, true);  // without a change, the page gets no message within 1 s
  const Message lines = bench.look()["state"]["lines"];
  EXPECT_EQ(lines[1]["now"].get<std::int64_t>() - lines[0]["now"].get<std::int64_t>(), 250'000);
}

TEST(PanelOfTwoLines, ANoteIsReportedWithItsLine) {
  TwoLines bench;
  bench.panel().note(1, milliseconds(5), "gone begins");
  Message frames = bench.look()["frames"];
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0]["line"], 1);
  EXPECT_EQ(frames[0]["entries"][0]["note"], "gone begins");
  bench.panel().note(0, milliseconds(5), "gone ends");
  frames = bench.look()["frames"];
  ASSERT_EQ(frames.size(), 1U);
  EXPECT_EQ(frames[0]["line"], 0);
  EXPECT_EQ(frames[0]["entries"][0]["note"], "gone ends");
}

TEST(PanelMessages, AFrameIsReportedWithItsTimesItsStationItsBytesAndItsMeaning) {
  PanelBench bench("EX9055D");
  static_cast<void>(bench.look());
  ASSERT_EQ(bench.ask("$01M"), "!019055");
  const Message message = bench.look();
  const Message& entries = message["frames"][0]["entries"];
  ASSERT_EQ(entries.size(), 2U);
  EXPECT_EQ(entries[0]["station"], 0);
  EXPECT_EQ(entries[0]["bytes"], "2430314D0D");
  EXPECT_EQ(entries[0]["text"], "$01M\\r");
  EXPECT_NE(entries[0]["meaning"].get<std::string>().find("$AAM"), std::string::npos);
  EXPECT_EQ(entries[0]["ended"].get<std::int64_t>() - entries[0]["began"].get<std::int64_t>(), 5208);
  EXPECT_EQ(entries[1]["station"], 1);
  EXPECT_FALSE(entries[1].contains("error"));
  EXPECT_EQ(entries[1]["number"], 1);
}

TEST(PanelMessages, NotesAndDamagedFramesAreReported) {
  PanelBench bench("EX9042D-M");
  static_cast<void>(bench.look());
  bench.send(ModuleBench::Bytes{1, 1, 0, 0, 0, 13, 0, 0});
  bench.end_frames();
  bench.panel().note(0, bench.now(), "gone begins");
  const Message message = bench.look();
  const Message& entries = message["frames"][0]["entries"];
  EXPECT_EQ(entries[0]["error"], "wrong CRC");
  EXPECT_EQ(entries.back()["note"], "gone begins");
}

TEST(PanelMessages, WithOneLineAMessageContainsOnlyTheLast250FramesAndNotes) {
  PanelBench bench("EX9042D");
  static_cast<void>(bench.look());
  constexpr std::size_t kMany = 2000;
  for (std::size_t i = 0; i < kMany; ++i) {
    bench.panel().note(0, bench.now(), std::to_string(i));
  }
  const Message message = bench.look();
  const Message& entries = message["frames"][0]["entries"];
  EXPECT_EQ(entries.size(), 250U);
  EXPECT_EQ(entries.back()["number"], kMany - 1);
  EXPECT_EQ(entries.back()["note"], std::to_string(kMany - 1));
  EXPECT_EQ(entries.front()["number"], kMany - 250);
  EXPECT_TRUE(bench.look().is_null());
}

TEST(PanelMessages, FaultsAreReportedWhenTheyAreAddedAndRemoved) {
  PanelBench bench("EX9042D");
  EXPECT_EQ(bench.look()["state"]["lines"][0]["faults"], Message::array());
  ASSERT_TRUE(bench.viewer().ask(R"({"id": 5, "do": "1 fault late-reply 50ms"})"));
  const Message message = bench.look();
  EXPECT_EQ(message["reply"]["id"], 5);
  EXPECT_EQ(message["reply"]["ok"], true);
  EXPECT_EQ(message["reply"]["text"], "ok 1");
  const Message& fault = message["state"]["lines"][0]["faults"][0];
  EXPECT_EQ(fault["text"], "late-reply 50ms");
  EXPECT_EQ(fault["number"], 1);
  EXPECT_EQ(fault["module"], 0);
  ASSERT_TRUE(bench.viewer().ask(R"({"id": 6, "do": "line hall fault off 1"})"));
  EXPECT_EQ(bench.look()["state"]["lines"][0]["faults"], Message::array());
}

TEST(PanelMessages, QuitIsRefusedAndARefusedCommandGetsAnError) {
  PanelBench bench("EX9042D");
  for (const std::string command : {"quit", " quit", "quit now", "1 input 0 on", "nonsense"}) {
    ASSERT_TRUE(bench.viewer().ask(R"({"id": 1, "do": ")" + command + "\"}")) << command;
    const Message reply = bench.look()["reply"];
    EXPECT_EQ(reply["ok"], false) << command;
    EXPECT_EQ(reply["text"].get<std::string>().rfind("error: ", 0), 0U) << command;
  }
}

TEST(PanelMessages, ClosingAPageRunsTheUndoOfCommandsThatSucceededAndThatThePageHasNotUndone) {
  PanelBench bench("EX9055D");
  auto page = bench.panel().viewer();
  ASSERT_TRUE(page->ask(R"({"id": 1, "do": "1 input 3 on", "undo": "1 input 3 off"})"));
  ASSERT_TRUE(page->ask(R"({"id": 2, "do": "1 input 4 on"})"));
  ASSERT_TRUE(page->ask(R"({"id": 3, "do": "nonsense", "undo": "1 input 5 on"})"));
  ASSERT_TRUE(page->ask(R"({"id": 4, "do": "1 input 6 on", "undo": "1 input 6 off"})"));
  ASSERT_TRUE(page->ask(R"({"id": 5, "do": "1 input 6 off"})"));
  bench.module().set_input(6, true);
  EXPECT_EQ(bench.module().input_levels(), 0x58U);
  page->leave();
  EXPECT_EQ(bench.module().input_levels(), 0x50U);
}

TEST(PanelMessages, AnErrorOfAnUndoCommandDoesNotEndTheProcess) {
  bool broken = false;
  Panel panel(
      [&broken](const std::string& /*command*/) -> Control::Reply {
        if (broken) {
          throw std::runtime_error("the capture cannot be written");
        }
        return {"ok", false};
      },
      nullptr, 1);
  auto leaves = panel.viewer();
  auto stays = panel.viewer();
  for (PanelViewer* page : {leaves.get(), stays.get()}) {
    ASSERT_TRUE(page->ask(R"({"id": 1, "do": "1 input 3 on", "undo": "1 input 3 off"})"));
  }
  broken = true;
  EXPECT_THROW(leaves->leave(), std::runtime_error);
  leaves.reset();
  stays.reset();  // as at the end of the program
}

TEST(PanelMessages, ARequestBeyondTheLimitOfUndoCommandsIsRejected) {
  PanelBench bench("EX9055D");
  auto page = bench.panel().viewer();
  const auto ask = [&page](int undo) {
    return page->ask(R"({"id": 1, "do": "1 input 3 on", "undo": ")" + std::to_string(undo) + "\"}");
  };
  constexpr int kLimit = 256;
  for (int i = 0; i < kLimit; ++i) {
    ASSERT_TRUE(ask(i)) << i;
  }
  EXPECT_FALSE(ask(kLimit));
}

TEST(PanelMessages, InitIsATerminalOnModelsWithoutARearSwitch) {
  for (const char* with : {"EX9042D-M", "EX9043D", "EX9052D", "EX9068D-M"}) {
    EXPECT_EQ(plate_layout(*find_model(with))["initTerminal"], true) << with;
  }
  for (const char* without : {"EX9043D-M", "EX9052D-M"}) {
    EXPECT_EQ(plate_layout(*find_model(without))["initTerminal"], false) << without;
  }
}

TEST(PanelMessages, AnInvalidRequestIsRejected) {
  PanelBench bench("EX9055D");
  for (const std::string text :
       {"", "x", "[]", "{}", R"({"id":1})", R"({"id":1,"do":2})", R"({"id":-1,"do":"list"})",
        R"({"id":"1","do":"list"})", R"({"id":1,"do":"list","x":1})", R"({"id":1,"do":"list"} x)",
        R"({"id":1,"do":"list","undo":2})", R"({"id":1,"undo":"list"})", R"({"do":"list","undo":"list"})",
        R"({"id":1,"do":"list","undo":"list","x":1})"}) {
    EXPECT_FALSE(bench.viewer().ask(text)) << text;
  }
  EXPECT_FALSE(bench.viewer().ask(R"({"id":1,"do":")" + std::string(1001, 'x') + "\"}"));
  EXPECT_FALSE(bench.viewer().ask(R"({"id":1,"do":"list","undo":")" + std::string(1001, 'x') + "\"}"));
  EXPECT_TRUE(bench.viewer().ask(R"({"id":1,"do":"list"})"));
}

}  // namespace
}  // namespace ex9000::sim
