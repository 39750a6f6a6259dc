// `ex9000 show`, `poll`, `set`, `save` and `restore` with simulated modules.
#include <gtest/gtest.h>

#include "sim/utility/command/show.hpp"
#include "tests/sim/utility/plant.hpp"
#include "tests/support/directory.hpp"

namespace ex9000::utility {
namespace {

/// The value in a row of `show`; "": there is no such row.
std::string shown(const Plant& plant, const std::string& name) {
  for (const std::string& line : sim::parts_of(plant.output(), '\n')) {
    const std::string lead = "  " + name + " ";
    if (line.compare(0, lead.size(), lead) == 0) {
      return line.substr(line.find_first_not_of(' ', lead.size()));
    }
  }
  return "";
}

TEST(Show, TellsWhatAModuleIsAndDoes) {
  for (const char* model : {"EX9052D-M@0A", "EX9052D@0A"}) {
    SCOPED_TRACE(model);
    Plant plant({std::string(model) + ",name=TANK"});
    plant.act("1 input 2 on");
    plant.act("1 pulse 3 x5");
    const std::string designation = std::string(model).substr(0, std::string(model).find('@'));
    EXPECT_EQ(plant.run({"show", "port", "10", "--model", designation}), 0) << plant.error();
    const bool modbus = plant.output().find(", Modbus at 9600 baud 8N1\n") != std::string::npos;
    EXPECT_EQ(modbus, std::string(model) == "EX9052D-M@0A");
    EXPECT_EQ(plant.output().find(designation + " 'TANK', firmware D01.00, serial number 0D000001, "), 0U)
        << plant.output();
    EXPECT_EQ(shown(plant, "address"), "10");
    EXPECT_EQ(shown(plant, "baud"), "9600");
    EXPECT_EQ(shown(plant, "edge"), "falling");
    EXPECT_EQ(shown(plant, "watchdog-timeout"), "25.5s");
    EXPECT_EQ(shown(plant, "checksum"), modbus ? "" : "off");
    EXPECT_EQ(shown(plant, "inputs"), "04");
    EXPECT_EQ(shown(plant, "latch high"), "0C");
    EXPECT_EQ(shown(plant, "latch low"), "08");
    EXPECT_EQ(shown(plant, "counters"), "0 0 0 5 0 0 0 0");
    EXPECT_EQ(shown(plant, "timeout status"), "clear");
    EXPECT_EQ(shown(plant, "last reset"), "power-on");
    EXPECT_EQ(plant.output().find("warning"), std::string::npos) << plant.output();
  }
}

TEST(Show, KnowsTheLayoutOfEachModel) {
  struct Row {
    const char* model;
    const char* command;
    const char* outputs;
    const char* inputs;
  };
  const Row kRows[] = {{"EX9043D@01", "@01A55A", "A55A", ""},
                       {"EX9042D@01", "@011F00", "1F00", ""},
                       {"EX9068D@01", "@0181", "81", ""},
                       {"EX9063D@01", "@015", "05", "04"},
                       {"EX9053D@01", "@01", "", "0004"},
                       {"EX9060D-M@01", "01 0F 0000 0004 01 05", "05", "04"},
                       {"EX9053D-M@01", "01 01 0020 0010", "", "0004"}};
  for (const Row& row : kRows) {
    SCOPED_TRACE(row.model);
    Plant plant({row.model});
    if (*row.inputs != '\0') {
      plant.act("1 input 2 on");
    }
    EXPECT_EQ(plant.run({"send", "port", row.command}), 0) << plant.output();
    EXPECT_EQ(plant.run({"show", "port", "1"}), 0) << plant.error();
    EXPECT_EQ(shown(plant, "outputs"), row.outputs);
    EXPECT_EQ(shown(plant, "inputs"), row.inputs);
  }
}

TEST(Show, Warns) {
  Plant plant({"EX9042D-M@01"});
  EXPECT_EQ(plant.run({"set", "port", "1", "watchdog-timeout=100ms", "watchdog=on", "baud=19200"}), 0);
  EXPECT_EQ(plant.run({"show", "port", "1"}), 0);
  for (const char* warning :
       {"warning: the host watchdog has timed out: outputs are blocked until ~AA1 or coil 0x010D\n",
        "warning: the host watchdog has timed out 1 times since the reset\n",
        "warning: from the next reset on, it speaks at 19200 baud 8N1\n"}) {
    EXPECT_NE(plant.output().find(warning), std::string::npos) << plant.output();
  }
  EXPECT_EQ(plant.run({"set", "port", "1", "watchdog-timeout=25.5s", "watchdog=on"}), 0);
  plant.act("1 hang");
  plant.wait(std::chrono::seconds(2));
  EXPECT_EQ(plant.run({"show", "port", "1", "--baud", "19200"}), 0) << plant.error();
  for (const char* warning :
       {"warning: the host watchdog is on, and the safe value is 0: a timeout switches all",
        "warning: the last reset came from the module itself: module watchdog\n"}) {
    EXPECT_NE(plant.output().find(warning), std::string::npos) << plant.output();
  }
}

TEST(Show, SaysWhatAnswersInstead) {
  Plant plant({"EX9052D-M@05,baud=19200,format=8E1"});
  EXPECT_EQ(plant.run({"show", "port", "5"}), 1);
  EXPECT_NE(
      plant.error().find("ex9000: 5: no reply at 9600 baud 8N1, but one at 19200 baud 8E1; set --baud and"),
      std::string::npos)
      << plant.error();
  plant.act("1 power off");
  EXPECT_EQ(plant.run({"show", "port", "5"}), 1);
  EXPECT_NE(
      plant.error().find("no reply at 9600 baud 8N1, nor anything else; check the supply, the wires A and B"),
      std::string::npos)
      << plant.error();
  plant.echoes = true;
  EXPECT_EQ(plant.run({"show", "port", "5"}), 1);
  EXPECT_NE(
      plant.error().find("no reply at 9600 baud 8N1, only the echo of the request: the adapter works; check"),
      std::string::npos)
      << plant.error();
}

TEST(Show, SaysThatBytesAreNoReply) {
  Plant plant({"EX9052D-M@05", "EX9042D-M@05"});
  EXPECT_EQ(plant.run({"show", "port", "5"}), 1);
  EXPECT_NE(plant.error().find("no reply, but bytes that are none: several modules with this address"),
            std::string::npos)
      << plant.error();
}

/// That to a request that has been repeated because of it. Rather no value than a wrong one.
TEST(Show, ALateReplyIsNotThatToTheNextRequest) {
  for (const char* module : {"EX9052D@05", "EX9052D@05,checksum=on", "EX9052D-M@05"}) {
    Plant plant({module});
    EXPECT_EQ(plant.run({"show", "port", "5"}), 0);
    const std::string settings = plant.output().substr(0, plant.output().find("state"));
    for (const int late : {230, 260, 300, 345, 500}) {
      SCOPED_TRACE(late);
      plant.act("fault off all");
      plant.act("fault late-reply " + std::to_string(late) + "ms");
      if (plant.run({"show", "port", "5"}) == 0) {
        EXPECT_EQ(plant.output().substr(0, plant.output().find("state")), settings);
      } else {
        EXPECT_GT(late, 230);
        EXPECT_NE(plant.error().find("no reply"), std::string::npos) << plant.error();
      }
    }
  }
}

TEST(Show, SaysThatTheWiresMayBeSwapped) {
  Plant plant({"EX9052D-M@05"});
  plant.hears = [](std::size_t /*at*/, std::uint8_t byte) { return static_cast<std::uint8_t>(~byte); };
  EXPECT_EQ(plant.run({"show", "port", "5"}), 1);
  EXPECT_NE(
      plant.error().find("no reply at 9600 baud 8N1, but bytes that are none: several modules with this "
                         "address, noise, or A and B swapped; try 'ex9000 scan'\n"),
      std::string::npos)
      << plant.error();
}

TEST(Show, AsksForTheModelOfAModuleThatDoesNotTellIt) {
  Plant plant({"EX9052D@05,name=TANK"});
  EXPECT_EQ(plant.run({"show", "port", "5"}), 2);
  EXPECT_EQ(plant.error(), "ex9000: 5: the model of 'TANK' is unknown; name it with --model\n");
}

TEST(Poll, PrintsWhatChanges) {
  Plant plant({"EX9052D-M@05"});
  plant.act("1 input 1 on");
  EXPECT_EQ(plant.run({"poll", "port", "5", "--count", "2"}), 0);
  const std::string line =
      "inputs 02  latch high 02  latch low 00  counters 0 0 0 0 0 0 0 0  timeout status clear\n";
  EXPECT_EQ(plant.output(), line + line);
}

/// The search for the second one goes through all modes, and back.
TEST(Poll, GoesOnWithoutAModuleThatIsMissing) {
  Plant plant({"EX9042D-M@05"});
  EXPECT_EQ(plant.run({"poll", "port", "5,6", "--count", "2"}), 0);
  EXPECT_EQ(plant.output(), "outputs 0000  timeout status clear\noutputs 0000  timeout status clear\n");
}

TEST(Poll, ShowsSeveralModulesInTheSamePlace) {
  Plant plant({"EX9042D-M@05", "EX9044D@06,checksum=on"});
  Environment environment = plant.environment();
  environment.output_is_terminal = true;
  Options options;
  options.rounds = 2;
  options.every = std::chrono::milliseconds(1);
  plant.sends = [&, count = 0](const Data& /*frame*/) mutable {
    const bool first_round_is_over = plant.output().find("6: ") != std::string::npos;
    if (first_round_is_over && count++ == 0) {
      plant.act("1 power off");
    }
    return true;
  };
  EXPECT_TRUE(poll(environment, {"port", "5,6"}, options));
  const std::string end = "\033[K\033[?7h\n";
  const std::string second =
      "\033[?7l6: outputs 00  inputs 00  latch high 00  latch low 00  counters 0 0 0 0  timeout status clear";
  EXPECT_EQ(plant.output(), "\033[?7l5: outputs 0000  timeout status clear" + end + second + end +
                                "\033[2A\033[?7l5: no reply" + end + second + end);
  EXPECT_TRUE(poll(environment, {"port", "6,5"}, options));  // 5 is off
  EXPECT_NE(plant.error().find("5: no reply at 9600 baud 8N1"), std::string::npos) << plant.error();
}

/// The echo of a request looks like the reply to it.
TEST(Set, AnEchoIsNoReply) {
  Plant plant({"EX9042D-M@05"});
  plant.echoes = true;
  unsigned writes = 0;
  plant.sends = [&](const Data& frame) {
    return frame[1] != 5 || ++writes != 1;  // the first one is lost
  };
  EXPECT_EQ(plant.run({"set", "port", "5", "watchdog=on"}), 0) << plant.error();
  EXPECT_EQ(writes, 2U);
}

/// Each setting in the protocol that it needs, as `show` reads it after a power cycle.
TEST(Set, ChangesEachSetting) {
  struct Row {
    const char* module;
    const char* setting;
    const char* output;
  };
  const Row kRows[] = {
      {"EX9052D-M@05", "protocol=ascii", "protocol: modbus -> ascii, in force from the next reset on\n"},
      {"EX9052D-M@05", "baud=115200", "baud: 9600 -> 115200, in force from the next reset on\n"},
      {"EX9052D-M@05", "format=8O1", "format: 8N1 -> 8O1, in force from the next reset on\n"},
      {"EX9052D-M@05", "edge=rising", "edge: falling -> rising\n"},
      {"EX9052D-M@05", "input-filters=1,2,3,4,5,6,7,8", "input-filters: 0 -> 1,2,3,4,5,6,7,8\n"},
      {"EX9052D-M@05", "inverted-inputs=81", "inverted-inputs: 0000 -> 0081\n"},
      {"EX9052D-M@05", "watchdog-timeout=0.5s", "watchdog-timeout: 25.5s -> 500ms\n"},
      {"EX9052D-M@05", "watchdog-feed=requests", "watchdog-feed: host-ok -> requests\n"},
      {"EX9052D-M@05", "watchdog=on", "watchdog: off -> on\n"},
      {"EX9052D-M@05", "response-delay=30", "response-delay: 0 -> 30\n"},
      {"EX9052D-M@05", "address=0x20", "address: 5 -> 32, in force from the next reset on\n"},
      {"EX9043D-M@05", "power-on-value=A5",
       "power-on-value: 0000 -> 00A5; also switches the outputs to this "
       "value now\n"},
      {"EX9068D-M@05", "safe-value=81",
       "safe-value: 0000 -> 0081; also switches the outputs to this value now\n"},
      {"EX9052D@05", "name=TANK 1", "name: 9052 -> TANK 1\n"},
      {"EX9052D@05", "edge=rising", "edge: falling -> rising, in force from the next reset on\n"},
      {"EX9052D@05", "address=200", "address: 5 -> 200\n"},
      {"EX9052D@05", "input-filters=20", "input-filters: 0 -> 20\n"},
      {"EX9052D@05", "watchdog-timeout=300ms", "watchdog-timeout: 25.5s -> 300ms\n"},
      {"EX9052D@05", "watchdog=on", "watchdog: off -> on\n"},
      {"EX9043D@05", "power-on-value=A5A5",
       "power-on-value: 0000 -> A5A5; also switches the outputs to this "
       "value now\n"},
      {"EX9068D@05", "safe-value=81",
       "safe-value: 0000 -> 0081; also switches the outputs to this value now\n"},
      {"EX9063D@05", "safe-value=5",
       "safe-value: 0000 -> 0005; also switches the outputs to this value now\n"},
  };
  for (const Row& row : kRows) {
    SCOPED_TRACE(std::string(row.module) + " " + row.setting);
    const std::string model = std::string(row.module).substr(0, std::string(row.module).find('@'));
    Plant plant({row.module});
    EXPECT_EQ(plant.run({"set", "port", "5", row.setting, "--dry-run"}), 0) << plant.error();
    EXPECT_EQ(plant.output(), row.output + std::string("nothing has been changed (--dry-run)\n"));
    EXPECT_EQ(plant.run({"set", "port", "5", row.setting, "--model", model}), 0) << plant.error();
    const bool at_reset = std::string(row.output).find("reset") != std::string::npos;
    EXPECT_EQ(plant.output(), row.output + std::string(at_reset ? "switch the module off and on\n" : ""));
    const std::string address = std::string(row.output) == "address: 5 -> 200\n" ? "200" : "5";
    EXPECT_EQ(plant.run({"set", "port", address, row.setting, "--model", model}), 0) << plant.error();
    EXPECT_EQ(plant.output(), "nothing to change\n");
  }
}

TEST(Set, NeedsInitForTheLineOfAModuleInAscii) {
  Plant plant({"EX9052D-M@05,protocol=ascii"});
  for (const char* setting : {"baud=19200", "checksum=on", "protocol=modbus"}) {
    EXPECT_EQ(plant.run({"set", "port", "5", setting}), 1);
    EXPECT_NE(plant.error().find("; tie INIT* to GND and repeat the command\n"), std::string::npos)
        << plant.error();
  }
  plant.act("1 init on");
  EXPECT_EQ(plant.run({"set", "port", "5", "baud=19200", "checksum=on", "protocol=modbus", "address=9"}), 0)
      << plant.error();
  plant.act("1 init off");
  plant.act("1 reset");
  EXPECT_EQ(plant.run({"show", "port", "9", "--baud", "19200"}), 0) << plant.error();
}

TEST(Set, RefusesWhatTheModuleCannotHaveAndChangesNothing) {
  const std::pair<const char*, const char*> kRows[] = {
      {"speed=9", "'speed': expected one of protocol, baud"},
      {"baud", "'baud': expected KEY=VALUE"},
      {"watchdog-feed=host-ok", "'watchdog-feed' is there twice; name each setting once"},
      {"baud=300", "baud: '300': expected"},
      {"power-on-value=01", "power-on-value: an EX9052D-M does not have this setting"},
      {"inverted-inputs=100", "inverted-inputs: '100': expected bits of the channels, at most 00FF"},
      {"input-filters=1,2", "input-filters: '1,2': expected one time for all inputs, or 8 times"},
      {"input-filters=2001", "input-filters: '2001': expected"},
      {"watchdog-timeout=26s", "watchdog-timeout: '26s': expected up to 25.5s, in steps of 0.1s"},
      {"watchdog-timeout=150ms", "watchdog-timeout: '150ms': expected up to 25.5s"},
      {"response-delay=31", "response-delay: '31': expected"},
      {"name=TOOLONG", "name: 'TOOLONG': expected 1 to 6 printable ASCII characters"},
      {"address=0", "address: '0': expected 1 to 247, because the module speaks Modbus"},
      {"address=256", "address: '256': expected an address, 0 to 255"},
      {"edge=both", "edge: 'both': expected rising or falling"},
  };
  for (const auto& [setting, problem] : kRows) {
    SCOPED_TRACE(setting);
    Plant plant({"EX9052D-M@05"});
    EXPECT_EQ(plant.run({"set", "port", "5", setting, "watchdog-feed=requests"}), 2);
    EXPECT_EQ(plant.error().find("ex9000: " + std::string(problem)), 0U) << plant.error();
    EXPECT_EQ(plant.run({"show", "port", "5"}), 0);
    EXPECT_EQ(shown(plant, "watchdog-feed"), "host-ok");
  }
}

TEST(Set, UpdatesAreAllowedOrNotInInitMode) {
  Plant plant({"EX9052D-M@05,init=on"});
  EXPECT_EQ(plant.run({"set", "port", "0", "updates-allowed=off"}), 0) << plant.error();
  EXPECT_EQ(plant.output(), "updates-allowed: on -> off\n");
  Plant locked({"EX9052D-M@05"});
  EXPECT_EQ(locked.run({"set", "port", "5", "updates-allowed=off"}), 1);
  EXPECT_EQ(locked.error(),
            "ex9000: updates-allowed: refuses to change this; tie INIT* to GND and repeat the command\n");
}

/// A value is not stored while the host watchdog has timed out.
TEST(Set, SaysThatATimeoutBlocksTheOutputs) {
  for (const char* module : {"EX9043D@05", "EX9043D-M@05"}) {
    Plant plant({module});
    plant.run({"set", "port", "5", "watchdog-timeout=100ms", "watchdog=on"});
    plant.wait();
    EXPECT_EQ(plant.run({"set", "port", "5", "safe-value=3"}), 1);
    EXPECT_NE(plant.error().find("host watchdog has timed out; "), std::string::npos) << plant.error();
  }
}

/// Another device, or noise that has passed all checks.
TEST(Show, SaysThatAReplyHasAnotherForm) {
  struct Row {
    const char* request;
    const char* reply;
    const char* error;
  };
  const Row kRows[] = {
      {"$052", "!05400600", ""},
      {"$052", "!0540FF00", "has the unknown baud code FF"},
      {"$052", "!05", "replies '!05' to $AA2, not !AATTCCFF"},
      {"~052", "!0512", "replies '12' to ~AA2, not EVV"},
      {"@05", ">00", "replies '00', not four hex digits"},
      {"#050", "!05x", "replies 'x' where a counter is expected"},
      {"~05X0252", "!05XY", "replies 'XY' where hex digits are expected"},
  };
  for (const Row& row : kRows) {
    Plant plant({"EX9052D@05"});
    plant.replies = [&](const Data& frame) -> std::optional<Data> {
      const std::string reply = std::string(row.reply) + "\r";
      return std::string(frame.begin(), frame.end() - 1) == row.request
                 ? std::optional(Data(reply.begin(), reply.end()))
                 : std::nullopt;
    };
    EXPECT_EQ(plant.run({"show", "port", "5"}), *row.error == '\0' ? 0 : 1) << plant.output();
    EXPECT_NE(plant.error().find(row.error), std::string::npos) << row.request << plant.error();
  }
}

TEST(Show, RefusesWhatAPortCannotCarry) {
  Plant plant({"EX9052D-M@05"});
  struct Row {
    std::vector<std::string> words;
    const char* error;
  };
  const Row kRows[] = {
      {{"show", "modbus-tcp:host", "0D000001"}, "carries no request by serial number"},
      {{"show", "modbus-tcp:host", "5", "--ascii"}, "Modbus TCP carries no DCON"},
      {{"show", "port", "0D000001", "--ascii"}, "a request by serial number is one of Modbus"},
      {{"panel", "modbus-tcp:host"}, "Modbus TCP shows no frames of the line"},
  };
  for (const Row& row : kRows) {
    EXPECT_EQ(plant.run(row.words), 2);
    EXPECT_NE(plant.error().find(row.error), std::string::npos) << plant.error();
  }
}

TEST(Set, SaysThatANameNeedsAscii) {
  Plant plant({"EX9052D-M@05"});
  EXPECT_EQ(plant.run({"set", "port", "5", "name=TANK"}), 1);
  EXPECT_NE(
      plant.error().find(
          "name: takes this only in ASCII; tie INIT* to GND, reset it, and use the address 0 at 9600 baud\n"),
      std::string::npos)
      << plant.error();
}

TEST(Set, SaysWhatIsChangedIfItEndsInBetween) {
  Plant plant({"EX9052D@05"});
  plant.sends = [&](const Data& frame) {
    if (frame[0] == '~' && frame[3] == 'X' && frame.size() > 9) {
      throw Interrupted();
    }
    return true;
  };
  EXPECT_EQ(plant.run({"set", "port", "5", "name=TANK", "response-delay=5", "input-filters=7", "--model",
                       "EX9052D"}),
            130);
  EXPECT_EQ(plant.error(), "ex9000: stopped (changed: name; perhaps: input-filters; not: response-delay)\n");
  plant.sends = [&](const Data& frame) {
    if (frame[0] == '~' && frame[3] == 'X' && frame.size() > 9) {
      plant.act("1 power off");
    }
    return true;
  };
  EXPECT_EQ(plant.run({"set", "port", "5", "edge=rising", "response-delay=5", "--model", "EX9052D"}), 1);
  EXPECT_NE(plant.error().find(
                "response-delay: gives no reply to ~05X02520005; check address, rate, format, checksum "
                "and wires (changed: edge; perhaps: response-delay; not: nothing)\n"),
            std::string::npos)
      << plant.error();
}

/// The reply to the new address is lost, or the module is in INIT mode with the stored address 00.
TEST(Set, FollowsTheModuleToItsNewAddress) {
  Plant plant({"EX9052D@05"});
  plant.sends = [&](const Data& frame) {
    plant.act("fault off all");
    if (frame[0] == '%') {
      plant.act("1 fault lost-reply every reply");
    }
    return true;
  };
  EXPECT_EQ(plant.run({"set", "port", "5", "address=9"}), 0) << plant.error();
  Plant init({"EX9052D@00,init=on"});
  EXPECT_EQ(init.run({"set", "port", "0", "address=7"}), 0) << init.error();
  init.act("1 init off");
  init.act("1 reset");
  EXPECT_EQ(init.run({"show", "port", "7"}), 0) << init.error();
}

TEST(Set, AnAddressInUseIsRefused) {
  Plant plant({"EX9043D@07", "EX9052D@08", "EX9052D-M@09"});
  for (const char* address : {"8", "9"}) {
    EXPECT_EQ(plant.run({"set", "port", "7", std::string("address=") + address}), 2);
    EXPECT_EQ(plant.error(), std::string("ex9000: address: another module has the address ") + address +
                                 "; choose a free one\n");
  }
  EXPECT_EQ(plant.run({"set", "port", "7,8", "address=10"}), 2);
  EXPECT_EQ(plant.error(), "ex9000: address: several modules cannot have the same; name one module\n");
}

/// It could expire while the rest is being set.
TEST(Set, TheHostWatchdogComesLast) {
  Plant plant({"EX9052D-M@05"});
  EXPECT_EQ(plant.run({"set", "port", "5", "watchdog=on", "watchdog-timeout=200ms", "response-delay=5",
                       "address=6"}),
            0)
      << plant.error();
  EXPECT_EQ(plant.output().rfind("watchdog: off -> on\n"), plant.output().find("switch") - 20)
      << plant.output();
}

class Saved : public testing::Test {
 protected:
  system::Directory directory_;
  std::string file_ = directory_ / "line.yaml";
};

TEST_F(Saved, AReplacedModuleGetsTheSettingsOfTheOldOne) {
  Plant old({"EX9052D-M@05,serial=1F3A", "EX9043D@07"});
  EXPECT_EQ(old.run({"set", "port", "5", "edge=rising", "input-filters=20", "watchdog-timeout=500ms"}), 0);
  EXPECT_EQ(old.run({"set", "port", "7", "name=VALVE", "safe-value=A5"}), 0);
  EXPECT_EQ(old.run({"save", "port", "5", file_}), 0);
  EXPECT_EQ(old.output(), "5: EX9052D-M, 13 settings\n");
  Plant fresh({"EX9052D-M@01"});
  EXPECT_EQ(fresh.run({"restore", "port", "1", file_}), 0) << fresh.error();
  EXPECT_EQ(fresh.output(),
            "edge: falling -> rising\ninput-filters: 0 -> 20\nwatchdog-timeout: 25.5s -> 500ms\n"
            "address: 1 -> 5, in force from the next reset on\nswitch the module off and on\n");
  fresh.act("1 reset");
  EXPECT_EQ(fresh.run({"restore", "port", "5", file_}), 0);
  EXPECT_EQ(fresh.output(), "nothing to change\n");

  EXPECT_EQ(old.run({"save", "port", "7,0D001F3A", file_, "--model", "EX9043D"}), 1);
  EXPECT_NE(old.error().find("--model: 0D001F3A is an EX9052D-M; leave out the option"), std::string::npos);
}

/// What a module takes only in ASCII waits until it speaks that.
TEST_F(Saved, AModuleInAsciiIsRestoredInTwoSteps) {
  Plant old({"EX9052D-M@05,protocol=ascii,checksum=on,name=TANK"});
  EXPECT_EQ(old.run({"save", "port", "5", file_, "--model", "EX9052D-M"}), 0) << old.error();
  Plant fresh({"EX9052D-M@01"});
  EXPECT_EQ(fresh.run({"restore", "port", "1", file_}), 1);
  EXPECT_EQ(fresh.output(),
            "protocol: modbus -> ascii, in force from the next reset on\n"
            "address: 1 -> 5, in force from the next reset on\nswitch the module off and on\n");
  EXPECT_EQ(fresh.error(),
            "left out, because the module takes it only in ASCII: checksum, name; reset it and repeat the "
            "command\n");
  fresh.act("1 init on");
  fresh.act("1 reset");
  fresh.wait();
  EXPECT_EQ(fresh.run({"restore", "port", "0", file_}), 0) << fresh.error();
  EXPECT_EQ(fresh.output(),
            "checksum: off -> on, in force from the next reset on\nname: 9052M -> TANK\n"
            "release INIT*, and switch the module off and on\n");
}

TEST_F(Saved, AModuleThatDisappearsCostsOnlyItsOwnSettings) {
  Plant plant({"EX9042D-M@01", "EX9042D-M@02"});
  plant.sends = [&](const Data& frame) {
    const bool protocol = frame[0] == 1 && frame[1] == 1 && frame[2] == 1;  // coil 0x0100
    if (protocol) {
      plant.act("1 power off");
    }
    return true;
  };
  EXPECT_EQ(plant.run({"save", "port", "1,2", file_}), 1);
  EXPECT_EQ(plant.run({"restore", "port", "2", file_}), 0) << plant.error();
  EXPECT_EQ(plant.output(), "nothing to change\n");
}

TEST_F(Saved, AWatchdogThatHasTimedOutIsReported) {
  Plant plant({"EX9042D-M@01"});
  EXPECT_EQ(plant.run({"set", "port", "1", "watchdog-timeout=100ms", "watchdog=on"}), 0);
  EXPECT_EQ(plant.run({"save", "port", "1", file_}), 0);
  EXPECT_EQ(plant.error(), "1: its host watchdog has timed out, which switched it off: the file says off\n");
}

TEST_F(Saved, AModuleThatDoesNotReplyCostsOnlyItsOwnSettings) {
  Plant plant({"EX9052D-M@05"});
  EXPECT_EQ(plant.run({"save", "port", "5,6", file_}), 1);
  EXPECT_NE(plant.error().find("6: not saved: 6: no reply at 9600 baud 8N1"), std::string::npos)
      << plant.error();
  EXPECT_EQ(plant.run({"restore", "port", "5", file_}), 0) << plant.error();
  EXPECT_EQ(plant.run({"save", "port", "7", directory_ / "other"}), 1);
  EXPECT_FALSE(std::filesystem::exists(directory_ / "other"));
  EXPECT_EQ(plant.run({"save", "port", "6-5", file_}), 2);
}

TEST_F(Saved, AFileMayHaveSeveralModules) {
  Plant plant({"EX9052D-M@05,serial=1F3A", "EX9052D-M@06"});
  EXPECT_EQ(plant.run({"set", "port", "6", "response-delay=6"}), 0);
  EXPECT_EQ(plant.run({"save", "port", "5,6", file_}), 0);
  Plant fresh({"EX9052D-M@01"});
  EXPECT_EQ(fresh.run({"restore", "port", "1", file_}), 2);
  EXPECT_NE(fresh.error().find(
                ": has 2 modules, but none with the address or serial number 1; name it with --entry"),
            std::string::npos)
      << fresh.error();
  EXPECT_EQ(fresh.run({"restore", "port", "1", file_, "--entry", "6", "--dry-run"}), 0);
  EXPECT_EQ(fresh.output().find("response-delay: 0 -> 6\naddress: 1 -> 6"), 0U) << fresh.output();
  EXPECT_EQ(fresh.run({"restore", "port", "1", file_, "--entry", "0D001F3A", "--dry-run"}), 0);
  EXPECT_EQ(fresh.output().find("address: 1 -> 5"), 0U) << fresh.output();
}

TEST_F(Saved, WrongFilesAreRefused) {
  const std::pair<std::string, std::string> kRows[] = {
      {"- model: EX9042D-M\n  settings: {address: 1}\n",
       ": the settings are those of an EX9042D-M, and the module is an EX9052D-M; their channels"},
      {"- model: [", ": line 1: "},
      {"- model: EX9052D-M\n  settings: {name: {}}\n", ": line 2: "},
      {"model: EX9052D-M\n", ": expected a list of modules, as 'ex9000 save' writes it"},
      {"- 5\n", ": line 1: expected a module with model and settings"},
      {"- model: EX9052D-M\n  settings: {speed: 1}\n", ": 'speed': expected one of"},
      {"- model: EX9052D-M\n  settings: {baud: 300}\n", "baud: '300': expected"},
  };
  for (const auto& [text, problem] : kRows) {
    SCOPED_TRACE(problem);
    system::write_file(file_, text);
    Plant plant({"EX9052D-M@05"});
    EXPECT_EQ(plant.run({"restore", "port", "5", file_}), 2);
    EXPECT_NE(plant.error().find(problem), std::string::npos) << plant.error();
  }
  Plant plant({"EX9052D-M@05"});
  EXPECT_EQ(plant.run({"restore", "port", "5", "/missing"}), 1);
  EXPECT_EQ(plant.run({"save", "port", "5", "/missing/file"}), 1);
}

}  // namespace
}  // namespace ex9000::utility
