// The control commands on a line in virtual time: what each does, and that a refused one does nothing.
#include "sim/control/control.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "tests/unit/module_bench.hpp"

namespace ex9000::sim {
namespace {

using Bytes = ModuleBench::Bytes;
using std::chrono::milliseconds;

bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }

/// Holds for every reply.
std::string checked(const Control::Reply& reply) {
  const std::string& text = reply.text;
  EXPECT_TRUE(text == "ok" || text.rfind("ok ", 0) == 0 || text.rfind("error: ", 0) == 0) << text;
  EXPECT_EQ(text.find_first_of("\r\n"), std::string::npos) << text;
  EXPECT_NE(text.back(), ' ') << text;
  return text;
}

/// A module, a master and somebody with his hands on the module.
class ControlBench : public ModuleBench {
 public:
  explicit ControlBench(const std::string& spec) : ModuleBench(spec), control_({{"", line()}}) {}

  std::string tell(const std::string& command) {
    const Control::Reply reply = control_.carry_out(command);
    EXPECT_FALSE(reply.quit) << command;
    return checked(reply);
  }

  /// `ok HEX`.
  unsigned number(const std::string& command) {
    const std::string reply = tell(command);
    EXPECT_EQ(reply.rfind("ok ", 0), 0U) << reply;
    EXPECT_EQ(reply.find_first_not_of("0123456789ABCDEFabcdef", 3), std::string::npos) << reply;
    return static_cast<unsigned>(std::stoul(reply.substr(3), nullptr, 16));
  }

  bool status_has(const std::string& part) { return has(tell("1 status"), part); }

  /// Until the module is being reset, or 2 s are over.
  void run_to_reset() {
    const VirtualTime gives_up = now() + milliseconds(2000);
    while (!status_has("mode=starting") && now() < gives_up) {
      line().bus().run_until(line().bus().next());
    }
  }

  /// All of the module that a command could have changed.
  std::string snapshot() {
    std::string text = tell("1 status") + tell("1 inputs") + tell("1 outputs") + tell("1 led");
    if (module().powered()) {
      const State& state = module().module().state();
      text += " reset status " + std::to_string(static_cast<int>(state.reset_status)) + " init " +
              std::to_string(static_cast<int>(state.init_asserted));
      for (unsigned channel = 0; channel < module().model().inputs; ++channel) {
        text += " " + std::to_string(state.inputs.counter(channel));
      }
    }
    return text;
  }

  /// Refused, and nothing has changed, now or a moment later.
  void expect_refused(const std::string& command) {
    run(milliseconds(20));
    const std::string before = snapshot();
    EXPECT_EQ(tell(command).rfind("error: ", 0), 0U) << command;
    run(milliseconds(20));
    EXPECT_EQ(snapshot(), before) << command;
  }

 private:
  Control control_;
};

/// Several modules.
class ThreeModules {
 public:
  ThreeModules() { line_.come_up(); }

  std::string tell(const std::string& command) { return checked(control_.carry_out(command)); }
  SimulatedModule& at(std::size_t position) { return line_.module(position - 1); }

 private:
  Line line_{
      {parse_module_spec("EX9042D-M@01"), parse_module_spec("EX9052D@02"), parse_module_spec("EX9055D@0A")},

      kPaced,
      [](std::uint8_t, ByteStatus) {}};
  Control control_{{{"", line_}}};
};

// --- power ---

TEST(ControlPower, OffSilencesTheModuleAndDropsItsOutputs) {
  ControlBench bench("EX9042D");
  ASSERT_EQ(bench.ask("@011FFF"), ">");
  EXPECT_EQ(bench.number("1 outputs"), 0x1FFFU);
  EXPECT_EQ(bench.tell("1 power off"), "ok");
  EXPECT_EQ(bench.number("1 outputs"), 0U);
  EXPECT_EQ(bench.ask("$01M"), "");
}

TEST(ControlPower, OnBringsItBackWithItsPowerOnValueAndResetStatus) {
  ControlBench bench("EX9042D");
  bench.ask("@010A05");
  ASSERT_EQ(bench.ask("~015P"), "!01");
  bench.ask("@010000");
  ASSERT_EQ(bench.ask("$015"), "!011");
  bench.tell("1 power off");
  EXPECT_EQ(bench.tell("1 power on"), "ok");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.number("1 outputs"), 0x0A05U);
  EXPECT_EQ(bench.ask("$015"), "!011");
}

TEST(ControlPower, ItMayBeSetToWhatItIsWithoutEffect) {
  ControlBench bench("EX9042D");
  bench.ask("@010001");
  bench.ask("$015");
  EXPECT_EQ(bench.tell("1 power on"), "ok");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.number("1 outputs"), 1U);
  EXPECT_EQ(bench.ask("$015"), "!010");
  EXPECT_EQ(bench.tell("1 power off"), "ok");
  EXPECT_EQ(bench.tell("1 power off"), "ok");
  EXPECT_EQ(bench.ask("$01M"), "");
}

TEST(ControlPower, OffInTheMiddleOfAWriteLeavesTheOldSettingsOrTheNew) {
  for (int cut = 0; cut <= 12; ++cut) {
    ControlBench bench("EX9042D,name=OLD");
    bench.send("~01ONEW\r");
    bench.run(milliseconds(cut));
    bench.tell("1 power off");
    bench.tell("1 power on");
    bench.run(milliseconds(100));
    const std::string name = bench.ask("$01M");
    EXPECT_TRUE(name == "!01OLD" || name == "!01NEW") << name;
  }
}

// --- reset and INIT* ---

TEST(ControlReset, ItIsAResetLikeAnyOther) {
  ControlBench bench("EX9055D");
  bench.tell("1 input 3 on");
  bench.tell("1 pulse 0 7");
  bench.ask("@01FF");
  bench.ask("$015");
  ASSERT_EQ(bench.ask("#010"), "!0100007");
  EXPECT_EQ(bench.tell("1 reset"), "ok");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("$015"), "!011");
  EXPECT_EQ(bench.ask("@01"), ">0008");
  EXPECT_EQ(bench.ask("#010"), "!0100000");
  EXPECT_EQ(bench.ask("$01L1"), "!000000");  // levels at reset are no edges
  EXPECT_TRUE(bench.status_has("watchdog-resets=0"));
}

TEST(ControlInit, TheModeIsChosenAtTheNextReset) {
  ControlBench bench("EX9042D-M@0A");
  EXPECT_EQ(bench.tell("1 init on"), "ok");
  bench.run(milliseconds(100));
  EXPECT_TRUE(bench.status_has("mode=normal"));
  bench.tell("1 reset");
  bench.run(milliseconds(100));
  EXPECT_TRUE(bench.status_has("mode=init"));
  EXPECT_EQ(bench.ask("$002"), "!0A400600");
  EXPECT_EQ(bench.tell("1 init off"), "ok");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("$002"), "!0A400600");
  bench.tell("1 reset");
  bench.run(milliseconds(100));
  EXPECT_TRUE(bench.status_has("mode=normal"));
  EXPECT_EQ(bench.ask("$002"), "");
}

TEST(ControlInit, PermissionIsThereAsSoonAsItIsDebounced) {
  ControlBench bench("EX9042D");
  EXPECT_EQ(bench.ask("%0101400700"), "?01");
  bench.tell("1 init on");
  bench.run(milliseconds(11));
  EXPECT_EQ(bench.ask("%0101400700"), "!01");
  bench.tell("1 init off");
  bench.run(milliseconds(11));
  EXPECT_EQ(bench.ask("%0101400600"), "?01");
}

TEST(ControlInit, ItCanBeTiedBeforeThePowerComes) {
  ControlBench bench("EX9042D@0A");
  bench.tell("1 power off");
  EXPECT_EQ(bench.tell("1 init on"), "ok");
  bench.tell("1 power on");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("$00M"), "!009042D");
}

// --- inputs ---

TEST(ControlInputs, EveryInputOfEveryModelHasALevelOfItsOwn) {
  for (const Model& model : kModels) {
    ControlBench bench(std::string(model.designation));
    unsigned levels = 0;
    for (unsigned channel = 0; channel < model.inputs; ++channel) {
      EXPECT_EQ(bench.tell("1 input " + std::to_string(channel) + " on"), "ok");
      levels |= 1U << channel;
      EXPECT_EQ(bench.number("1 inputs"), levels);
    }
    for (unsigned channel = 0; channel < model.inputs; ++channel) {
      EXPECT_EQ(bench.tell("1 input " + std::to_string(channel) + " off"), "ok");
      levels &= ~(1U << channel);
      EXPECT_EQ(bench.number("1 inputs"), levels);
    }
  }
}

TEST(ControlInputs, AModuleReadsLatchesAndCountsWhatIsSet) {
  ControlBench bench("EX9052D");
  bench.tell("1 input 6 on");
  EXPECT_EQ(bench.ask("@01"), ">4000");
  EXPECT_EQ(bench.ask("$01L1"), "!400000");
  EXPECT_EQ(bench.ask("$01L0"), "!000000");
  bench.tell("1 input 6 on");
  bench.tell("1 input 6 off");
  EXPECT_EQ(bench.ask("@01"), ">0000");
  EXPECT_EQ(bench.ask("$01L0"), "!400000");
  EXPECT_EQ(bench.ask("#016"), "!0100001");
}

TEST(ControlInputs, LevelsOutlastAResetAndAPowerCut) {
  ControlBench bench("EX9052D");
  bench.tell("1 input 1 on");
  bench.tell("1 reset");
  EXPECT_EQ(bench.number("1 inputs"), 2U);
  bench.tell("1 power off");
  EXPECT_EQ(bench.number("1 inputs"), 2U);
  EXPECT_EQ(bench.tell("1 input 7 on"), "ok");
  bench.tell("1 power on");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("@01"), ">8200");
}

TEST(ControlInputs, AChannelThatTheModelLacksIsRefused) {
  for (const Model& model : kModels) {
    ControlBench bench(std::string(model.designation));
    const std::string beyond = std::to_string(model.inputs);
    for (const std::string& command : {"1 input " + beyond + " on", "1 input " + beyond + " off",
                                       "1 pulse " + beyond, "1 pulse " + beyond + " 3"}) {
      bench.expect_refused(command);
      EXPECT_TRUE(has(bench.tell(command), std::string(model.designation))) << command;
    }
  }
}

// --- pulses ---

TEST(ControlPulse, OnePulseIsBothEdgesAndTheLevelStays) {
  for (const bool high : {false, true}) {
    for (const std::string edge : {"falling", "rising"}) {
      ControlBench bench("EX9052D,edge=" + edge);
      bench.tell(high ? "1 input 2 on" : "1 input 2 off");
      bench.ask("$01C");
      bench.ask("$01C2");
      EXPECT_EQ(bench.tell("1 pulse 2"), "ok");
      EXPECT_EQ(bench.number("1 inputs"), high ? 4U : 0U);
      EXPECT_EQ(bench.ask("@01"), high ? ">0400" : ">0000");
      EXPECT_EQ(bench.ask("$01L1"), "!040000");
      EXPECT_EQ(bench.ask("$01L0"), "!040000");
      EXPECT_EQ(bench.ask("#012"), "!0100001") << edge << high;
    }
  }
}

TEST(ControlPulse, AsManyAsAreAskedForAreCountedAtOnceUpToAMillion) {
  struct Case {
    const char* count;
    const char* ascii;  ///< modulo 100000
    unsigned modbus;    ///< modulo 65536
  };
  const std::vector<Case> cases{
      {"1", "00001", 1},          {"1023", "01023", 1023},    {"1024", "01024", 1024},
      {"65535", "65535", 65535},  {"65536", "65536", 0},      {"99999", "99999", 34463},
      {"100000", "00000", 34464}, {"999999", "99999", 16959}, {"1000000", "00000", 16960}};
  for (const Case& pulses : cases) {
    ControlBench ascii("EX9052D");
    const VirtualTime before = ascii.now();
    EXPECT_EQ(ascii.tell(std::string("1 pulse 7 ") + pulses.count), "ok");
    EXPECT_EQ(ascii.now(), before);
    EXPECT_EQ(ascii.ask("#017"), std::string("!01") + pulses.ascii) << pulses.count;
    EXPECT_EQ(ascii.ask("#016"), "!0100000");
    ControlBench modbus("EX9052D-M");
    EXPECT_EQ(modbus.tell(std::string("1 pulse 0 ") + pulses.count), "ok");
    EXPECT_EQ(modbus.ask(Bytes{1, 0x04, 0, 0, 0, 1}),
              (Bytes{1, 0x04, 2, static_cast<std::uint8_t>(pulses.modbus >> 8U),
                     static_cast<std::uint8_t>(pulses.modbus & 0xFFU)}))
        << pulses.count;
  }
}

TEST(ControlPulse, ACountThatIsNoneIsRefused) {
  ControlBench bench("EX9052D");
  for (const char* count :
       {"0", "00", "1000001", "10000000", "999999999", "4294967296", "4294967297", "18446744073709551617",
        "99999999999999999999999999", "-1", "+1", "0x10", "1e3", "1.0", "1,000", "ten", "1 2", "1;"}) {
    bench.expect_refused(std::string("1 pulse 0 ") + count);
  }
}

TEST(ControlPulse, WithoutPowerNothingIsCounted) {
  ControlBench bench("EX9052D");
  bench.tell("1 power off");
  EXPECT_EQ(bench.tell("1 pulse 0 5"), "ok");
  bench.tell("1 power on");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.ask("#010"), "!0100000");
}

// --- outputs, LED, status ---

TEST(ControlOutputs, EveryOutputOfEveryModelIsABitOfItsOwn) {
  for (const Model& model : kModels) {
    if (model.outputs == 0) {
      continue;
    }
    const std::string spec(model.designation);
    ControlBench bench(spec + (model.speaks_modbus() ? ",protocol=ascii" : ""));
    for (unsigned channel = 0; channel < model.outputs; ++channel) {
      const std::string group = channel < 8 ? "1" : "B";
      ASSERT_EQ(bench.ask("#01" + group + std::to_string(channel % 8) + "01"), ">") << spec << channel;
      EXPECT_EQ(bench.number("1 outputs"), (2U << channel) - 1) << spec << channel;
    }
  }
}

TEST(ControlLed, ItIsOnFlashesAfterATimeoutAndIsOffWithoutPower) {
  ControlBench bench("EX9042D");
  EXPECT_EQ(bench.tell("1 led"), "ok on");
  ASSERT_EQ(bench.ask("~013101"), "!01");
  bench.run(milliseconds(200));
  EXPECT_EQ(bench.tell("1 led"), "ok flashing");
  bench.tell("1 power off");
  EXPECT_EQ(bench.tell("1 led"), "ok off");
  bench.tell("1 power on");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.tell("1 led"), "ok flashing");
  ASSERT_EQ(bench.ask("~011"), "!01");
  EXPECT_EQ(bench.tell("1 led"), "ok on");
}

TEST(ControlLed, ItFlashesWhileTheSettingsCannotBeRead) {
  ControlBench bench("EX9042D");
  std::fill(bench.module().memory().contents().begin(), bench.module().memory().contents().end(),
            std::uint8_t{0x5A});
  bench.tell("1 reset");
  bench.run(milliseconds(100));
  EXPECT_EQ(bench.tell("1 led"), "ok flashing");
  ASSERT_EQ(bench.ask("~01ONEW"), "!01");
  EXPECT_EQ(bench.tell("1 led"), "ok on");
}

TEST(ControlStatus, ItTellsWhatIsInForce) {
  ControlBench ascii("EX9042D@1f,baud=115200,checksum=on");
  const std::string of_ascii = ascii.tell("1 status");
  for (const char* part : {"EX9042D", "address=1F", "protocol=ascii", "baud=115200", "checksum=on",
                           "mode=normal", "host-watchdog=disabled"}) {
    EXPECT_TRUE(has(of_ascii, part)) << of_ascii;
  }
  ControlBench modbus("EX9068D-M@F7,baud=1200,init=off");
  const std::string of_modbus = modbus.tell("1 status");
  for (const char* part : {"EX9068D-M", "address=F7", "protocol=modbus", "baud=1200", "mode=normal"}) {
    EXPECT_TRUE(has(of_modbus, part)) << of_modbus;
  }
  ControlBench init("EX9068D-M@F7,baud=1200,init=on");
  const std::string of_init = init.tell("1 status");
  for (const char* part : {"address=00", "protocol=ascii", "baud=9600", "checksum=off", "mode=init"}) {
    EXPECT_TRUE(has(of_init, part)) << of_init;
  }
}

TEST(ControlStatus, ItFollowsTheHostWatchdog) {
  ControlBench bench("EX9042D");
  ASSERT_EQ(bench.ask("~01310A"), "!01");
  EXPECT_TRUE(bench.status_has("host-watchdog=enabled timeout=1.0s"));
  bench.run(milliseconds(1000));
  EXPECT_TRUE(bench.status_has("host-watchdog=expired"));
  ASSERT_EQ(bench.ask("~011"), "!01");
  EXPECT_TRUE(bench.status_has("host-watchdog=disabled"));
}

TEST(ControlStatus, AModuleThatStartsOrHasNoPowerHasOneToo) {
  ControlBench bench("EX9042D");
  bench.tell("1 reset");
  EXPECT_TRUE(bench.status_has("EX9042D"));
  EXPECT_TRUE(bench.status_has("mode=starting"));
  EXPECT_TRUE(has(bench.tell("list"), "EX9042D"));
  bench.tell("1 power off");
  EXPECT_TRUE(bench.status_has("EX9042D"));
  EXPECT_TRUE(bench.status_has("power=off"));
  EXPECT_TRUE(has(bench.tell("list"), "EX9042D"));
}

// --- hang ---

TEST(ControlHang, TheModuleWatchdogResetsItWithin1600msWheneverItHangs) {
  for (int moment = 0; moment < 400; moment += 37) {
    ControlBench bench("EX9042D");
    bench.ask("@010003");
    ASSERT_EQ(bench.ask("~015P"), "!01");
    bench.ask("@011FFF");
    bench.ask("$015");
    bench.run(milliseconds(moment));
    ASSERT_TRUE(bench.status_has("watchdog-resets=0"));
    EXPECT_EQ(bench.tell("1 hang"), "ok");
    const VirtualTime hung = bench.now();
    bench.run_to_reset();
    EXPECT_LE(bench.now() - hung, milliseconds(1600)) << moment;
    bench.run(milliseconds(100));
    EXPECT_TRUE(bench.status_has("watchdog-resets=1")) << moment;
    EXPECT_EQ(bench.number("1 outputs"), 3U);
    EXPECT_EQ(bench.ask("$015"), "!011");
  }
}

TEST(ControlHang, AHungModuleIsSilentAndKeepsItsOutputsUntilThen) {
  ControlBench bench("EX9042D");
  bench.ask("@011FFF");
  bench.tell("1 hang");
  EXPECT_EQ(bench.ask("$01M"), "");
  EXPECT_EQ(bench.ask("@010000"), "");
  EXPECT_EQ(bench.number("1 outputs"), 0x1FFFU);
}

TEST(ControlHang, ASecondOneDelaysNothing) {
  ControlBench bench("EX9042D");
  bench.tell("1 hang");
  bench.run(milliseconds(900));
  EXPECT_EQ(bench.tell("1 hang"), "ok");
  bench.run(milliseconds(800));
  EXPECT_TRUE(bench.status_has("watchdog-resets=1"));
  bench.run(milliseconds(5000));
  EXPECT_TRUE(bench.status_has("watchdog-resets=1"));
  EXPECT_EQ(bench.ask("$01M"), "!019042D");
}

TEST(ControlHang, AResetOrAPowerCutEndsItBefore) {
  for (const bool cut : {false, true}) {
    ControlBench bench("EX9042D");
    bench.tell("1 hang");
    if (cut) {
      bench.tell("1 power off");
      bench.run(milliseconds(5000));
      bench.tell("1 power on");
    } else {
      bench.tell("1 reset");
    }
    bench.run(milliseconds(100));
    EXPECT_EQ(bench.ask("$01M"), "!019042D");
    bench.run(milliseconds(5000));
    EXPECT_TRUE(bench.status_has("watchdog-resets=0"));
  }
}

TEST(ControlHang, EverythingElseCanBeDoneToAHungModule) {
  ControlBench bench("EX9055D");
  bench.tell("1 hang");
  for (const char* command : {"1 input 0 on", "1 pulse 1 100000", "1 init on", "1 init off", "1 inputs",
                              "1 outputs", "1 led", "1 status", "list", "1 power on"}) {
    EXPECT_EQ(bench.tell(command).rfind("ok", 0), 0U) << command;
  }
  EXPECT_EQ(bench.number("1 inputs"), 1U);
  bench.run(milliseconds(1800));
  EXPECT_EQ(bench.ask("@01"), ">0001");
}

// --- without power ---

TEST(ControlWithoutPower, ResetAndHangAreRefusedAndEverythingElseIsAnswered) {
  ControlBench bench("EX9055D");
  bench.tell("1 power off");
  bench.expect_refused("1 reset");
  bench.expect_refused("1 hang");
  EXPECT_EQ(bench.number("1 inputs"), 0U);
  EXPECT_EQ(bench.number("1 outputs"), 0U);
  EXPECT_EQ(bench.tell("1 led"), "ok off");
  bench.run(milliseconds(5000));
  EXPECT_FALSE(bench.module().powered());
}

// --- the commands without a module ---

TEST(ControlLine, ListNamesEveryModuleByItsPosition) {
  ThreeModules modules;
  const std::string text = modules.tell("list");
  EXPECT_TRUE(has(text, "1 EX9042D-M at 01")) << text;
  EXPECT_TRUE(has(text, "2 EX9052D at 02")) << text;
  EXPECT_TRUE(has(text, "3 EX9055D at 0A")) << text;
  modules.tell("2 power off");
  EXPECT_TRUE(has(modules.tell("list"), "2 EX9052D"));
}

TEST(ControlLine, APositionIsThatModuleAndNoOther) {
  ThreeModules modules;
  EXPECT_EQ(modules.tell("3 input 0 on"), "ok");
  EXPECT_EQ(modules.at(2).input_levels(), 0);
  EXPECT_EQ(modules.at(3).input_levels(), 1);
  EXPECT_EQ(modules.tell("2 power off"), "ok");
  EXPECT_TRUE(modules.at(1).powered());
  EXPECT_FALSE(modules.at(2).powered());
  EXPECT_TRUE(modules.at(3).powered());
}

TEST(ControlLine, APositionWithoutAModuleIsRefused) {
  ThreeModules modules;
  for (const char* position : {"0", "00", "4", "10", "256", "4294967297", "18446744073709551617", "-1", "+1",
                               "1.", "0x1", "1st", "A", "#1", "**"}) {
    EXPECT_EQ(modules.tell(std::string(position) + " power off").rfind("error: ", 0), 0U) << position;
    for (const std::size_t module : {1U, 2U, 3U}) {
      EXPECT_TRUE(modules.at(module).powered()) << position;
    }
  }
}

TEST(ControlLine, HelpNamesEveryCommand) {
  ControlBench bench("EX9052D");
  const std::string text = bench.tell("help");
  for (const char* command : {"power", "reset", "init", "input", "pulse", "inputs", "outputs", "led", "hang",
                              "status", "fault FAULT", "fault off K|all", "faults", "list", "help", "quit"}) {
    EXPECT_TRUE(has(text, command)) << command;
    EXPECT_TRUE(has(control_commands(), command)) << command;
  }
}

TEST(ControlLine, QuitIsAcknowledgedAndOnlyTheWholeWordQuits) {
  ModuleBench bench("EX9052D");
  Control control({{"", bench.line()}});
  const Control::Reply reply = control.carry_out("quit");
  EXPECT_EQ(reply.text, "ok");
  EXPECT_TRUE(reply.quit);
  for (const char* command : {"quit now", "1 quit", "Quit", "quitt", "qui", "quit quit"}) {
    const Control::Reply refused = control.carry_out(command);
    EXPECT_EQ(checked(refused).rfind("error: ", 0), 0U) << command;
    EXPECT_FALSE(refused.quit) << command;
  }
}

// --- faults ---

TEST(ControlFault, StrikesFromNowOnAndItsNumberEndsIt) {
  ControlBench bench("EX9042D");
  EXPECT_EQ(bench.tell("1 fault lost-reply"), "ok 1");
  EXPECT_EQ(bench.ask("$01M"), "");
  EXPECT_EQ(bench.tell("fault bit-errors 1e-9"), "ok 2");
  EXPECT_EQ(bench.tell("fault off 1"), "ok");
  EXPECT_EQ(bench.ask("$01M"), "!019042D");
  EXPECT_EQ(bench.tell("faults"), "ok 1 fault: 2* x1 bit-errors 1e-9");
  EXPECT_EQ(bench.tell("fault off all"), "ok");
  EXPECT_EQ(bench.tell("faults"), "ok 0 faults:");
  EXPECT_EQ(bench.tell("fault off all"), "ok");
}

TEST(ControlFault, TheListTellsWhatStrikesHowOftenAndWhom) {
  ThreeModules modules;
  EXPECT_EQ(modules.tell("2 fault gone"), "ok 1");
  EXPECT_EQ(modules.tell("3 fault   power-cut \t after 3 writes"), "ok 2");
  EXPECT_EQ(modules.tell("fault lost-reply every 10th reply"), "ok 3");
  EXPECT_EQ(modules.tell("faults"),
            "ok 3 faults: 1* x1 2 gone; 2 x0 3 power-cut after 3 writes; 3 x0 lost-reply every 10th reply");
  EXPECT_FALSE(modules.at(2).powered());
  EXPECT_TRUE(modules.at(1).powered());
}

TEST(ControlFault, WhoeverIsGoneHasNoPowerUntilItIsBackAndTheSwitchIsAnotherMatter) {
  ControlBench bench("EX9042D");
  bench.tell("1 fault gone");
  EXPECT_TRUE(bench.status_has("power=off"));
  bench.tell("1 power on");
  EXPECT_TRUE(bench.status_has("power=off"));
  bench.tell("fault off all");
  EXPECT_TRUE(bench.status_has("power=on"));
  bench.tell("1 fault gone");
  bench.tell("1 power off");
  bench.tell("fault off all");
  EXPECT_TRUE(bench.status_has("power=off"));
}

TEST(ControlFault, AWrongOneIsRefusedAndNothingIsChanged) {
  ControlBench bench("EX9055D");
  for (const char* command : {"fault",
                              "1 fault",
                              "fault off",
                              "fault off 1",
                              "fault off 0",
                              "fault off -1",
                              "fault off 1 2",
                              "fault off all all",
                              "fault off ALL",
                              "fault off 99999999999999999999",
                              "faults 1",
                              "1 faults",
                              "1 fault off 1",
                              "2 fault gone",
                              "0 fault gone",
                              "fault bogus",
                              "fault gone at noon",
                              "fault gone every 1s",
                              "1 fault bit-errors 0.1",
                              "1 fault echo 2ms",
                              "1 fault foreign-traffic 00",
                              "fault gone at 1ms",
                              "1 fault wrong-rate 300",
                              "faultgone",
                              "line",
                              "line x",
                              "line x fault",
                              "line x fault gone"}) {
    bench.expect_refused(command);
    EXPECT_EQ(bench.tell("faults"), "ok 0 faults:") << command;
  }
}

TEST(ControlFault, ARefusalNamesWhatIsWrongAndTheMend) {
  ControlBench bench("EX9055D");
  EXPECT_TRUE(has(bench.tell("fault lost"), "'lost' is no fault; there are bit-errors, lost-bytes"));
  EXPECT_TRUE(
      has(bench.tell("1 fault bit-errors 1"), "befalls the line, not a module; leave out the module's"));
  EXPECT_TRUE(has(bench.tell("fault off 7"), "no fault 7 on this line; 'faults' lists them"));
  EXPECT_TRUE(has(bench.tell("fault off"), "the command is fault off K|all"));
  EXPECT_TRUE(has(bench.tell("fault gone at 1ms"), "that is over, it is 100ms now"));
  EXPECT_TRUE(has(bench.tell("line hall faults"), "no line 'hall'; the only one has no name"));
}

// --- several lines ---

/// Two modules on the one, one on the other.
class TwoLines {
 public:
  TwoLines() {
    hall_.come_up();
    yard_.come_up();
  }

  std::string tell(const std::string& command) { return checked(control_.carry_out(command)); }
  Line& hall() { return hall_; }
  Line& yard() { return yard_; }

 private:
  Line hall_{{parse_module_spec("EX9042D@01"), parse_module_spec("EX9052D@02")},
             kPaced,
             [](std::uint8_t, ByteStatus) {}};
  Line yard_{{parse_module_spec("EX9055D@01")}, kPaced, [](std::uint8_t, ByteStatus) {}};
  Control control_{{{"hall", hall_}, {"yard", yard_}}};
};

TEST(ControlLines, ModulesAreNumberedThroughAllOfThem) {
  TwoLines lines;
  EXPECT_EQ(lines.tell("list"),
            "ok 3 modules: 1 EX9042D at 01 on hall, 2 EX9052D at 02 on hall, 3 EX9055D at 01 on yard");
  EXPECT_EQ(lines.tell("3 input 0 on"), "ok");
  EXPECT_EQ(lines.yard().module(0).input_levels(), 1);
  EXPECT_EQ(lines.hall().module(1).input_levels(), 0);
  EXPECT_TRUE(has(lines.tell("4 power off"), "no module 4; there are 1 to 3"));
}

TEST(ControlLines, AFaultIsOfTheLineThatIsNamedOrWhoseModuleIs) {
  TwoLines lines;
  EXPECT_EQ(lines.tell("3 fault gone"), "ok 1");
  EXPECT_FALSE(lines.yard().module(0).powered());
  EXPECT_TRUE(lines.hall().module(0).powered());
  EXPECT_EQ(lines.tell("line hall fault gone"), "ok 1");
  EXPECT_FALSE(lines.hall().module(0).powered());
  EXPECT_FALSE(lines.hall().module(1).powered());
  EXPECT_EQ(lines.tell("line yard faults"), "ok 1 fault: 1* x1 3 gone");
  EXPECT_EQ(lines.tell("line hall faults"), "ok 1 fault: 1* x1 gone");
  EXPECT_EQ(lines.tell("line hall fault off 1"), "ok");
  EXPECT_TRUE(lines.hall().module(0).powered());
  EXPECT_FALSE(lines.yard().module(0).powered());
  EXPECT_EQ(lines.tell("line yard fault off all"), "ok");
  EXPECT_TRUE(lines.yard().module(0).powered());
}

TEST(ControlLines, WhatIsOfALineWantsItsName) {
  TwoLines lines;
  for (const char* command : {"fault gone", "faults", "fault off all"}) {
    EXPECT_EQ(lines.tell(command), "error: there are several lines; put 'line NAME' in front") << command;
  }
  EXPECT_EQ(lines.tell("line shed faults"), "error: no line 'shed'; there are hall, yard");
  EXPECT_TRUE(has(lines.tell("line hall"), "the command is line NAME fault FAULT"));
  for (const char* command : {"line hall list", "line hall 1 power off", "line hall quit",
                              "line hall line hall faults", "line hall fault", "line hall fault off 1"}) {
    EXPECT_EQ(lines.tell(command).rfind("error: ", 0), 0U) << command;
  }
  EXPECT_TRUE(lines.hall().module(0).powered());
}

// --- what is no command ---

TEST(ControlRefusals, WhatIsNoCommandIsRefused) {
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
                              "1 pulse 0 1 1",
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

TEST(ControlRefusals, BytesThatAreNoTextAreRefusedInOneLine) {
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

TEST(ControlForm, BlanksTabsAndACarriageReturnMakeNoDifference) {
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
