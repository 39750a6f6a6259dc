// The modules of a line on the panel of `ex9000 panel`.
#include <gtest/gtest.h>

#include <memory>
#include <string>
#include <vector>

#include "sim/utility/real_line/real_line.hpp"
#include "tests/sim/utility/plant.hpp"

namespace ex9000::utility {
namespace {

using sim::Message;

/// What one page of the panel shows of a plant.
class OnPanel : public ::testing::Test {
 protected:
  OnPanel() {
    Search search;
    search.modes = {kMode};
    search.last = 3;
    search.patience = std::chrono::milliseconds(80);
    std::vector<FoundModule> found;
    scan(
        real_.line(), search, [&](const FoundModule& module) { found.push_back(module); },
        [](std::size_t /*done*/, std::size_t /*of*/) {});
    real_.show_on(panel_, found);
    page_ = panel_.viewer();
    look();
  }

  void look() {
    real_.look();
    panel_.look();
    message_ = Message::parse(page_->next());
    for (const Message& module : message_["state"]["modules"]) {
      faces_[module["module"]].update(module);
    }
  }

  const Message& plate(std::size_t module) { return faces_[module]["plate"]; }

  Message answer_to(const std::string& request, unsigned address) {
    EXPECT_TRUE(page_->ask(Message{{"id", 1}, {"line", 0}, {"address", address}, {"ask", request}}.dump()));
    look();
    return message_["answers"][0];
  }

  static constexpr hal::SerialMode kMode{9600, LineFormat::k8N1};

  Plant plant_{{"EX9042D-M@01,name=PUMPS", "EX9052D@02,checksum=on", "EX9044D-M@03"}};
  RealLine real_{plant_.environment(), {}, kMode, std::chrono::milliseconds(300)};
  sim::Panel panel_{
      nullptr,
      [this](std::size_t /*line*/, sim::RequestQueue::Request request) { real_.ask(std::move(request)); }, 1};
  std::unique_ptr<sim::PanelViewer> page_;
  Message message_;
  std::map<std::size_t, Message> faces_;
};

TEST_F(OnPanel, AFaceShowsWhatTheModuleReports) {
  EXPECT_EQ(message_["hello"]["simulated"], false);
  // In the order of the scan: those in Modbus first.
  EXPECT_EQ(message_["hello"]["modules"][0]["model"], "EX9042D-M");
  EXPECT_EQ(message_["hello"]["modules"][1]["model"], "EX9044D-M");
  EXPECT_EQ(message_["hello"]["modules"][2]["model"], "EX9052D");
  EXPECT_EQ(plate(0), Message::parse(R"({"initMode": false, "address": 1, "protocol": "modbus",
      "checksum": false, "serialNumber": "0D000001", "baud": 9600, "format": "8N1", "powered": true,
      "listening": true, "led": "on", "outputs": 0, "inputs": 0})"));
  EXPECT_EQ(faces_[0]["stored"]["settings"]["name"], "PUMPS");
  EXPECT_EQ(plate(2)["protocol"], "ascii");
  EXPECT_EQ(plate(2)["checksum"], true);

  plant_.act("2 input 7 on");
  plant_.act("2 pulse 0 x2");
  plant_.act("3 input 1 on");
  plant_.wait();
  look();
  EXPECT_EQ(plate(1)["inputs"], 0x02);
  EXPECT_EQ(plate(2)["inputs"], 0x80);
  EXPECT_EQ(faces_[2]["records"],
            Message::parse(R"({"high": 129, "low": 1, "counters": [2,0,0,0,0,0,0,0]})"));
}

TEST_F(OnPanel, TheConsoleSendsARequestBetweenTwoLooks) {
  const Message answer = answer_to("05 0003 FF00", 1);
  EXPECT_EQ(answer["ok"], true);
  EXPECT_EQ(answer["text"], "01 05 00 03 FF 00 7C 3A");
  EXPECT_EQ(plate(0)["outputs"], 0x08);
  EXPECT_EQ(answer_to("05 0003 FF00", 9)["text"], "no reply within 500 ms");
  EXPECT_EQ(answer_to("#**", 1)["ok"], true);
  EXPECT_EQ(answer_to("$", 1)["ok"], false);
}

TEST_F(OnPanel, AReplyIsOneOfTheModuleThatWasAsked) {
  EXPECT_EQ(answer_to("$02MD3", 0)["text"], "!02905253\\r");
  unsigned replies = 0;
  for (const Message& entry : message_["frames"][0]["entries"]) {
    if (entry["station"] != 0) {
      const std::string bytes = entry["bytes"];
      EXPECT_EQ(entry["station"], bytes.rfind("FD46090D000001", 0) == 0   ? 1
                                  : bytes.rfind("FD46090D000003", 0) == 0 ? 2
                                                                          : 3)
          << entry;
      ++replies;
    }
  }
  EXPECT_GT(replies, 10U);
}

TEST_F(OnPanel, AModuleThatDisappearsHasNoStateUntilItIsBack) {
  plant_.act("1 power off");
  look();
  EXPECT_EQ(plate(0), Message::parse(R"({"initMode": false, "address": 1, "protocol": "modbus",
      "checksum": false, "serialNumber": "0D000001", "baud": 9600, "format": "8N1", "powered": false,
      "listening": false, "led": "no reply"})"));
  EXPECT_EQ(plate(1)["powered"], true);
  plant_.act("1 power on");
  plant_.wait();
  look();
  EXPECT_EQ(plate(0)["powered"], true);
  EXPECT_EQ(plate(0)["outputs"], 0);
}

TEST_F(OnPanel, OneLostReplyChangesNothing) {
  for (std::size_t lost = 0; lost < 20; ++lost) {
    std::size_t frame = 0;
    plant_.sends = [&](const Data& /*bytes*/) { return frame++ != lost; };
    look();
    EXPECT_EQ(plate(0)["powered"], true) << lost;
    EXPECT_EQ(plate(1)["powered"], true) << lost;
    EXPECT_EQ(plate(2)["powered"], true) << lost;
  }
}

TEST_F(OnPanel, RequestsOfPagesDoNotKeepModulesFromBeingPolled) {
  const std::string request = R"({"id": 1, "line": 0, "address": 9, "ask": "03 0000 0008"})";
  for (int i = 0; i < 10; ++i) {
    EXPECT_TRUE(page_->ask(request));
  }
  plant_.act("3 input 1 on");
  plant_.wait();
  look();
  EXPECT_EQ(plate(1)["inputs"], 0x02);
}

/// A frame with the byte of a DCON delimiter makes modules in ASCII wait for CR.
TEST_F(OnPanel, ADconRequestAfterAModbusRequestGetsItsReply) {
  for (int i = 0; i < 3; ++i) {
    answer_to("05 0000 FF00", 0x24);
    EXPECT_EQ(answer_to("$02MD3", 0)["ok"], true);
  }
}

TEST_F(OnPanel, AnEchoIsNoReplyToAPage) {
  plant_.echoes = true;
  look();
  plant_.act("1 power off");
  EXPECT_EQ(answer_to("05 0003 FF00", 1)["ok"], false);
}

TEST_F(OnPanel, AFaceFollowsWhatAPageChanges) {
  answer_to("06 0080 0007", 1);
  EXPECT_EQ(plate(0)["address"], 7);
  answer_to("05 0104 FF00", 7);
  EXPECT_EQ(faces_[0]["hostWatchdog"]["enabled"], true);
  EXPECT_EQ(answer_to("%02084006401D", 0)["ok"], true);  // with a checksum
  EXPECT_EQ(plate(2)["address"], 8);
  EXPECT_EQ(plate(2)["powered"], true);
}

TEST_F(OnPanel, EachLookAsksOneOfTheModulesThatDoNotReply) {
  for (const char* module : {"1", "2", "3"}) {
    plant_.act(std::string(module) + " power off");
  }
  look();
  plant_.act("1 power on");
  plant_.wait();
  for (int i = 0; i < 3; ++i) {
    EXPECT_EQ(plate(0)["powered"], false);
    look();
    if (plate(0)["powered"] == true) {
      break;
    }
  }
  EXPECT_EQ(plate(0)["powered"], true);
  plant_.act("3 power on");
  plant_.wait();
  look();
  look();
  EXPECT_EQ(plate(1)["powered"], true);
  EXPECT_EQ(plate(2)["powered"], false);
}

TEST_F(OnPanel, AHostWatchdogThatTimesOutIsShown) {
  ASSERT_EQ(plant_.run({"set", "line", "1", "watchdog-timeout=0.5s", "watchdog=on"}), 0) << plant_.error();
  plant_.wait(std::chrono::seconds(1));
  look();
  EXPECT_EQ(faces_[0]["hostWatchdog"]["timedOut"], true);
  EXPECT_EQ(plate(0)["led"], "flashing");
}

TEST_F(OnPanel, APageCannotActOnRealModules) {
  EXPECT_TRUE(page_->ask(R"({"id": 1, "do": "1 power off"})"));
  look();
  EXPECT_EQ(message_["reply"]["ok"], false);
  EXPECT_EQ(plate(0)["powered"], true);
}

/// In INIT mode, it answers at 00 until the next reset.
TEST(OnPanelInInitMode, AModuleStaysAtAddress0) {
  Plant plant({"EX9052D@05,init=on"});
  RealLine real(plant.environment(), {}, {9600, LineFormat::k8N1}, std::chrono::milliseconds(300));
  sim::Panel panel(
      nullptr,
      [&](std::size_t /*line*/, sim::RequestQueue::Request request) { real.ask(std::move(request)); }, 1);
  Search search;
  search.modes = {{9600, LineFormat::k8N1}};
  search.speaks = Speaks::Ascii;
  search.last = 0;
  search.patience = std::chrono::milliseconds(80);
  std::vector<FoundModule> found;
  scan(
      real.line(), search, [&](const FoundModule& module) { found.push_back(module); },
      [](std::size_t /*done*/, std::size_t /*of*/) {});
  real.show_on(panel, found);
  const auto page = panel.viewer();
  EXPECT_TRUE(page->ask(R"({"id": 1, "line": 0, "address": 0, "ask": "%0007400600"})"));
  real.look();
  panel.look();
  const Message message = Message::parse(page->next());
  EXPECT_EQ(message["answers"][0]["text"], "!07\\r");
  EXPECT_EQ(message["state"]["modules"][0]["plate"]["powered"], true);
  EXPECT_EQ(message["state"]["modules"][0]["plate"]["address"], 0);
  EXPECT_EQ(message["state"]["modules"][0]["stored"]["settings"]["address"], "7");
}

}  // namespace
}  // namespace ex9000::utility
