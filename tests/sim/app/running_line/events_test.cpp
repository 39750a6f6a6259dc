// Tests what the log says happens to a line and its modules, besides frames.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "sim/app/running_line/line_record.hpp"
#include "sim/notation/actions.hpp"
#include "sim/notation/module_notation.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;
using Events = std::vector<std::string>;

class EventsOfALine : public testing::Test {
 protected:
  EventsOfALine() { line_.come_up(); }

  void act(const std::string& command) {
    sim::act({{"", line_, nullptr, false, [this](const std::string& text) { record_.event(text); }}},
             words_of(command));
  }
  /// Sends a DCON command, and lets `time` pass.
  void ask(const std::string& command, VirtualTime time = milliseconds(100)) {
    const std::string frame = command + "\r";
    line_.master().send(std::vector<std::uint8_t>(frame.begin(), frame.end()).data(), frame.size());
    line_.wires().run_for(time);
  }
  /// The notes since the last call, without their times.
  Events take() {
    Events events;
    for (const std::string& entry : std::exchange(printed_, {})) {
      const auto note = entry.find("  - ");
      if (note != std::string::npos) {
        events.push_back(entry.substr(note + 4));
      }
    }
    return events;
  }

  std::vector<std::string> printed_;
  Line line_{{parse_module_spec("EX9055D@0A")}, kPaced, [](std::uint8_t /*byte*/, ByteStatus /*status*/) {}};
  LineRecord record_{line_, "line", LogFormat::Text,
                     [this](const std::string& text) { printed_.push_back(text); }};
};

TEST_F(EventsOfALine, AreNotPrintedUnlessFramesAre) {
  act("1 input 3 on");
  record_.event("text");
  EXPECT_EQ(take(), Events());
}

TEST_F(EventsOfALine, AreTheActionsThatChangeSomethingAndTheirEffects) {
  record_.print_frames();
  act("1 input 3 on");
  act("1 input 3 on");
  act("1 pulse 0 x5");
  act("1 init on");
  act("1 status");
  act("1 power off");
  EXPECT_EQ(take(), (Events{"0A EX9055D: input 3 on", "1 input 3 on", "1 input 3 on",
                            "0A EX9055D: input 0 pulse x5", "1 pulse 0 x5", "0A EX9055D: INIT* tied to GND",
                            "1 init on", "0A EX9055D: power off", "1 power off"}));
}

TEST_F(EventsOfALine, SayWhyOutputsChangeUnlessARequestHasChangedThem) {
  record_.print_frames();
  ask("@0A03");
  EXPECT_EQ(take(), Events{"0A EX9055D: outputs 0003"});
  ask("~0A3101", seconds(1));  // the host watchdog, 0.1 s
  EXPECT_EQ(take(), (Events{"0A EX9055D: settings stored", "0A EX9055D: outputs 0000: host watchdog",
                            "0A EX9055D: settings stored"}));
  ask("~0A1");  // clears the timeout status
  ask("@0A01");
  take();
  act("1 power off");
  act("1 power on");
  EXPECT_EQ(take(), (Events{"0A EX9055D: power off", "0A EX9055D: outputs 0000: no power", "1 power off",
                            "0A EX9055D: power on", "1 power on"}));
  line_.wires().run_for(milliseconds(100));
  ask("@0A01");
  take();
  act("1 reset");
  EXPECT_EQ(take(), (Events{"0A EX9055D: reset", "0A EX9055D: outputs 0000: reset", "1 reset"}));
}

TEST_F(EventsOfALine, TheModuleWatchdogIsNamed) {
  record_.print_frames();
  act("1 hang");
  line_.wires().run_for(seconds(2));
  EXPECT_EQ(take(), (Events{"1 hang", "0A EX9055D: reset by the module watchdog"}));
}

}  // namespace
}  // namespace ex9000::sim
