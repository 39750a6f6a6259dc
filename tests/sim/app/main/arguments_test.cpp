// Tests the command line of ex9000-sim: the modules and the options of a run.
#include "sim/app/main/arguments.hpp"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "tests/sim/app/main/parsed_arguments.hpp"

namespace ex9000::sim {
namespace {

Setup all_accepted(const std::vector<const char*>& words) {
  const Parsed parsed = parse(words);
  EXPECT_TRUE(parsed.setup) << parsed.error;
  EXPECT_EQ(parsed.exit_status, 0);
  EXPECT_EQ(parsed.output, "");
  EXPECT_EQ(parsed.error, "");
  Setup none;
  none.lines.emplace_back();
  return parsed.setup.value_or(none);
}

/// Parses words that describe a single line, and returns that line.
LineSetup accepted(const std::vector<const char*>& words) {
  const Setup setup = all_accepted(words);
  EXPECT_EQ(setup.lines.size(), 1U);
  return setup.lines[0];
}

TEST(Arguments, OneModuleIsEnough) {
  const LineSetup arguments = accepted({"EX9042D-M"});
  ASSERT_EQ(arguments.modules.size(), 1U);
  EXPECT_EQ(arguments.modules[0].model->designation, "EX9042D-M");
  EXPECT_FALSE(arguments.baud);
  EXPECT_FALSE(arguments.format);
  EXPECT_FALSE(all_accepted({"EX9042D-M"}).log);
  EXPECT_FALSE(arguments.strict_gaps);
  EXPECT_FALSE(arguments.instant);
  EXPECT_EQ(arguments.pty, "ex9000.tty");
  EXPECT_FALSE(arguments.tcp);
  EXPECT_FALSE(arguments.serial);
  EXPECT_FALSE(all_accepted({"EX9042D-M"}).control);
}

TEST(Arguments, ModulesKeepTheirOrder) {
  const LineSetup arguments =
      accepted({"EX9042D-M@01", "EX9052D-M@02,edge=rising", "9068d-m@0A,protocol=ascii"});
  ASSERT_EQ(arguments.modules.size(), 3U);
  EXPECT_EQ(arguments.modules[0].settings.address, 0x01);
  EXPECT_EQ(arguments.modules[1].settings.address, 0x02);
  EXPECT_EQ(arguments.modules[1].settings.format, 0x80);
  EXPECT_EQ(arguments.modules[2].settings.address, 0x0A);
  EXPECT_EQ(arguments.modules[2].settings.protocol, Protocol::Ascii);
}

TEST(Arguments, AnEepromFileMayEndWithJson) {
  const LineSetup arguments = accepted({"EX9042D@01,eeprom=a.json", "EX9052D@02"});
  ASSERT_EQ(arguments.modules.size(), 2U);
  EXPECT_EQ(arguments.modules[0].eeprom, "a.json");
}

TEST(Arguments, OptionsMayComeBeforeAfterAndBetweenModules) {
  const LineSetup arguments = accepted({"--log", "EX9042D", "--baud", "1200", "EX9052D@02", "--strict-gaps"});
  EXPECT_EQ(arguments.modules.size(), 2U);
  EXPECT_TRUE(all_accepted({"--log", "EX9042D"}).log);
  EXPECT_TRUE(arguments.strict_gaps);
  EXPECT_EQ(arguments.baud, 1200U);
}

TEST(Arguments, TheLogFormatIsTextOrJson) {
  EXPECT_EQ(all_accepted({"EX9042D", "--log"}).log, LogFormat::Text);
  EXPECT_EQ(all_accepted({"EX9042D", "--log", "text"}).log, LogFormat::Text);
  EXPECT_EQ(all_accepted({"EX9042D", "--log", "json"}).log, LogFormat::Json);
  EXPECT_EQ(all_accepted({"EX9042D", "--log=json"}).log, LogFormat::Json);
  EXPECT_EQ(all_accepted({"EX9042D", "--log", "--strict-gaps"}).log, LogFormat::Text);
  expect_error({"EX9042D", "--log=xml"}, "--log: 'xml'", "text, json or off");
  expect_error({"EX9042D", "--log="}, "--log", "--help");
}

TEST(Arguments, PanelTakesAnOptionalPortAndCannotBeCombinedWithSpeedMax) {
  EXPECT_FALSE(all_accepted({"EX9042D"}).panel);
  for (const std::vector<const char*>& words : {std::vector<const char*>{"EX9042D", "--panel"},
                                                {"--panel", "EX9042D"},
                                                {"--panel", "--log", "EX9042D"}}) {
    const auto setup = all_accepted(words);
    ASSERT_TRUE(setup.panel);
    EXPECT_FALSE(setup.panel->port);
    EXPECT_EQ(setup.lines[0].modules.size(), 1U);
  }
  EXPECT_EQ(all_accepted({"--panel", "8080", "EX9042D"}).panel->port, 8080);
  EXPECT_EQ(all_accepted({"EX9042D", "--panel=0"}).panel->port, 0);
  EXPECT_EQ(accepted({"--panel", "9042D"}).modules.size(), 1U);
  expect_error({"EX9042D", "--panel", "65536"}, "--panel: '65536'", "0 to 65535");
  expect_error({"EX9042D", "--panel=web"}, "--panel: 'web'", "0 to 65535");
  expect_error({"EX9042D", "--panel="}, "--panel", "--help");
  expect_error({"EX9042D", "--panel", "--speed", "max", "--for", "1s"}, "--speed: max",
               "cannot be combined with --panel");
}

TEST(Arguments, WatchIsAcceptedExceptWithAJsonLog) {
  EXPECT_FALSE(all_accepted({"EX9042D"}).watch);
  EXPECT_TRUE(all_accepted({"EX9042D", "--watch", "--log"}).watch);
  EXPECT_TRUE(all_accepted({"--watch", "EX9042D", "--speed", "max", "--for", "1s"}).watch);
  expect_error({"EX9042D", "--watch", "--log", "json"}, "--watch: cannot be combined with --log json",
               "both write to standard output; leave out one of them");
}

/// `sim/run` passes --panel and --log, and then the arguments of its user, which may contain these options
/// again.
TEST(Arguments, OnlyTheLastPanelAndLogOptionsApply) {
  EXPECT_EQ(all_accepted({"EX9042D", "--panel", "--log", "--panel", "8080"}).panel->port, 8080);
  EXPECT_EQ(all_accepted({"EX9042D", "--panel", "--log", "--log", "json"}).log, LogFormat::Json);
  const auto without = all_accepted({"EX9042D", "--panel", "--log", "--panel", "off", "--log", "off"});
  EXPECT_FALSE(without.panel);
  EXPECT_FALSE(without.log);
  expect_error({"EX9042D", "--tcp", "0", "--tcp", "0"}, "--tcp", "--help");
}

TEST(Arguments, AModuleMayFollowTheLogOption) {
  EXPECT_EQ(accepted({"--log", "json", "EX9042D"}).modules.size(), 1U);
  EXPECT_EQ(accepted({"--log", "EX9042D", "EX9052D@02"}).modules.size(), 2U);
}

TEST(Arguments, CaptureTakesAPath) {
  EXPECT_FALSE(all_accepted({"EX9042D"}).capture);
  EXPECT_EQ(all_accepted({"EX9042D", "--capture", "line.pcapng"}).capture, "line.pcapng");
}

TEST(Arguments, TheLinkToThePseudoTerminalCanBeChosen) {
  EXPECT_EQ(accepted({"EX9042D", "--pty", "line.tty"}).pty, "line.tty");
  EXPECT_EQ(accepted({"EX9042D", "--pty=line.tty"}).pty, "line.tty");
}

TEST(Arguments, AnotherPortReplacesTheDefaultPseudoTerminalButNotANamedOne) {
  EXPECT_FALSE(accepted({"EX9042D", "--tcp", "5020"}).pty);
  EXPECT_FALSE(accepted({"EX9042D", "--serial", "/dev/ttyUSB0"}).pty);
  EXPECT_EQ(accepted({"EX9042D", "--tcp", "5020", "--pty", "a"}).pty, "a");
}

TEST(Arguments, TcpTakesHostAndPortOrAPortAlone) {
  const auto tcp = [](const char* text) {
    const TcpAddress address = accepted({"EX9042D", "--tcp", text}).tcp.value_or(TcpAddress());
    return address.host + " " + std::to_string(address.port);
  };
  EXPECT_EQ(tcp("5020"), "127.0.0.1 5020");
  EXPECT_EQ(tcp(":5020"), "127.0.0.1 5020");
  EXPECT_EQ(tcp("0.0.0.0:0"), "0.0.0.0 0");
  EXPECT_EQ(tcp("localhost:65535"), "127.0.0.1 65535");
  EXPECT_EQ(tcp("[::1]:5020"), "::1 5020");
  for (const char* wrong :
       {"", ":", "localhost", "localhost:", ":65536", "::1:5020", "a:-1", "5020x", "1:2:3"}) {
    expect_error({"EX9042D", "--tcp", wrong}, "--tcp", "HOST:PORT");
  }
  for (const char* name : {"simulator.local:5020", "256.0.0.1:5020", "[::g]:5020"}) {
    expect_error({"EX9042D", "--tcp", name}, "--tcp", "expected a numeric address or localhost as HOST");
  }
}

TEST(Arguments, ModbusTcpTakesAnAddressAndReplacesTheDefaultPseudoTerminal) {
  const LineSetup line = accepted({"EX9042D-M", "--modbus-tcp", "502"});
  EXPECT_EQ(line.modbus_tcp.value_or(TcpAddress()).host, "127.0.0.1");
  EXPECT_EQ(line.modbus_tcp.value_or(TcpAddress()).port, 502);
  EXPECT_FALSE(line.tcp);
  EXPECT_FALSE(line.pty);
  EXPECT_EQ(accepted({"EX9042D-M", "--modbus-tcp", "502", "--tcp", "503", "--pty", "a"}).pty, "a");
  expect_error({"EX9042D-M", "--modbus-tcp", "a:502"}, "--modbus-tcp",
               "expected a numeric address or localhost");
  expect_error({"EX9042D-M", "--modbus-tcp", "502", "--tcp", "localhost:502"}, "--modbus-tcp: 127.0.0.1:502",
               "two ports cannot share an address; name one for each");
  expect_error({"EX9042D-M", "--modbus-tcp", "502", "--speed", "max", "--for", "1s"}, "--speed: ",
               "max cannot be combined with --modbus-tcp, because masters follow the wall clock");
}

TEST(Arguments, TheLineIsPacedOrInstantAndStrictGapsRequireAPacedLine) {
  EXPECT_FALSE(accepted({"EX9042D", "--line", "paced"}).instant);
  EXPECT_TRUE(accepted({"EX9042D", "--line", "instant"}).instant);
  expect_error({"EX9042D", "--line", "fast"}, "--line: 'fast'", "instant or paced");
  expect_error({"EX9042D", "--line", "instant", "--strict-gaps"},
               "--strict-gaps: ", "cannot be combined with --line instant");
}

TEST(Arguments, ASerialLineCannotBeCombinedWithAnotherPort) {
  const std::string mend =
      "cannot be combined with --pty, --tcp or --modbus-tcp, because the master is on the serial line; leave "
      "out --serial or the other ports";
  expect_error({"EX9042D", "--serial", "/dev/ttyUSB0", "--tcp", "5020"}, "--serial: ", mend);
  expect_error({"EX9042D", "--serial", "/dev/ttyUSB0", "--pty", "a"}, "--serial: ", mend);
  expect_error({"EX9042D", "--serial", "/dev/ttyUSB0", "--modbus-tcp", "502"}, "--serial: ", mend);
}

TEST(Arguments, EchoRequiresASerialLineAndASerialLineCannotBeInstant) {
  EXPECT_FALSE(accepted({"EX9042D", "--serial", "/dev/ttyUSB0"}).echo);
  EXPECT_EQ(accepted({"EX9042D-M", "--modbus-tcp", "0", "--modbus-timeout", "1s"}).modbus_timeout,
            std::chrono::seconds(1));
  expect_error({"EX9042D-M", "--modbus-timeout", "1s"}, "--modbus-timeout: ",
               "requires --modbus-tcp; add --modbus-tcp, or leave out --modbus-timeout");
  expect_error({"EX9042D-M", "--modbus-tcp", "0", "--modbus-timeout", "1"},
               "--modbus-timeout: ", "'1': expected a duration");
  EXPECT_TRUE(accepted({"EX9042D", "--serial", "/dev/ttyUSB0", "--echo"}).echo);
  expect_error({"EX9042D", "--echo"}, "--echo: ", "requires --serial; add --serial, or leave out --echo");
  expect_error(
      {"EX9042D", "--serial", "/dev/ttyUSB0", "--line", "instant"}, "--line: instant",
      "cannot be combined with --serial, because bytes on a serial line take time; leave out one of them");
}

TEST(Arguments, TwoModulesCannotShareAnEepromFile) {
  expect_error({"EX9042D,eeprom=a", "EX9052D@02,eeprom=a"},
               "eeprom=a: ", "two modules cannot share a file; name one for each");
  EXPECT_EQ(accepted({"EX9042D,eeprom=a", "EX9052D@02,eeprom=b"}).modules[1].eeprom, "b");
}

TEST(Arguments, OnePathCannotServeTwoPurposes) {
  expect_error({"EX9042D,eeprom=a", "--pty", "b", "--control", "./b"},
               "--pty: ", "b: is already used for something else; name another path");
  expect_error({"EX9042D,eeprom=a", "--control", "a"},
               "eeprom=a: ", "is already used for something else; name another path");
  expect_error({"EX9042D,eeprom=a", "--pty", "x/../a"},
               "eeprom=a: ", "is already used for something else; name another path");
}

TEST(Arguments, TheLineAcceptsEveryBaudRateOfTheModules) {
  for (const char* rate : {"1200", "2400", "4800", "9600", "19200", "38400", "57600", "115200"}) {
    EXPECT_EQ(std::to_string(accepted({"EX9042D", "--baud", rate}).baud.value_or(0)), rate);
  }
}

TEST(Arguments, AMissingModuleIsRefusedWithAnExample) {
  expect_error({}, "no module", "EX9042D-M");
  expect_error({"--log"}, "no module", "--help");
}

TEST(Arguments, AWrongModuleIsRefused) {
  expect_error({"EX9999"}, "EX9999", "--models");
  expect_error({"EX9042D", "EX9052D@GG"}, "EX9052D@GG", "hex digits");
  expect_error({""}, "empty argument", "--models");
}

TEST(Arguments, TheMessageAboutAWrongRateNamesAValidRate) {
  for (const char* rate : {"300", "9601", "9600x", "fast", "-1", "0"}) {
    expect_error({"EX9042D", "--baud", rate}, rate, "9600");
  }
}

TEST(Arguments, TheFormatOfTheLineIsOneOfFourFormats) {
  EXPECT_EQ(accepted({"EX9042D", "--format", "8N2"}).format, LineFormat::k8N2);
  EXPECT_EQ(accepted({"EX9042D", "--format", "8O1"}).format, LineFormat::k8O1);
  expect_error({"EX9042D", "--format", "8M1"}, "--format", "8N1, 8N2, 8E1 or 8O1");
}

TEST(Arguments, AnEmptyRateIsRefused) { expect_error({"EX9042D", "--baud", ""}, "--baud", "9600"); }

TEST(Arguments, AnUnknownOptionIsRefused) { expect_error({"EX9042D", "--verbose"}, "--verbose", "--help"); }

TEST(Arguments, AnOptionWithoutItsValueIsRefused) {
  expect_error({"EX9042D", "--baud"}, "--baud", "--help");
  for (const char* option : {"--pty", "--tcp", "--serial", "--line", "--control", "--capture"}) {
    expect_error({"EX9042D", option}, option, "--help");
  }
}

TEST(Arguments, AnEmptyPathIsRefused) {
  for (const char* option : {"--pty", "--serial", "--control", "--capture"}) {
    expect_error({"EX9042D", option, ""}, std::string(option) + ": is empty", "name a path");
  }
  expect_error({"EX9042D,eeprom="}, "eeprom=: is empty", "name a path");
}

// --- inputs that change by themselves, faults, seed, threads and speed ---

TEST(Arguments, AnInputIsAssignedToTheModuleAtTheGivenPosition) {
  const LineSetup arguments = accepted({"EX9042D", "EX9052D@02", "--input", "2 0 square 100ms", "--input",
                                        "2 7 key at 2s for 300ms", "--log"});
  EXPECT_TRUE(arguments.modules[0].inputs.empty());
  ASSERT_EQ(arguments.modules[1].inputs.size(), 2U);
  EXPECT_EQ(arguments.modules[1].inputs[0].kind, InputProgram::Kind::Square);
  EXPECT_EQ(arguments.modules[1].inputs[1].channel, 7U);
}

TEST(Arguments, AWrongInputIsRefused) {
  for (const auto& [text, wrong, mend] : std::vector<std::array<const char*, 3>>{
           {"", "--input", "a module's position first"},
           {" 1 0 square 1s", "' 1 0 square 1s'", "a module's position first"},
           {"square 100ms", "'square 100ms'", "for example '1 0 square 100ms'"},
           {"1", "ex9000-sim: --input: the channel is missing; ", "'CHANNEL square PERIOD'"},
           {"0 0 square 1s", "no module 0", "expected a position from 1 to 1"},
           {"2 0 square 1s", "no module 2", "expected a position from 1 to 1"},
           {"99999999999 0 square 1s", "no module 99999999999", "expected a position from 1 to 1"},
           {"1 8 square 1s", "no input '8'", "0 to 7"},
           {"1 0 sine 1s", "'sine'", "square PERIOD"},
       }) {
    expect_error({"EX9052D", "--input", text}, wrong, mend);
  }
  expect_error({"EX9052D", "--input"}, "--input", "--help");
}

TEST(Arguments, AFaultIsAssignedToTheLineOrToTheModuleAtTheGivenPosition) {
  const std::vector<Fault> faults =
      accepted({"EX9042D", "EX9052D@02", "--fault", "bit-errors 1e-4", "--fault",
                "2 lost-reply every 10th reply", "--fault", "gone at 12.5s"})
          .faults;
  ASSERT_EQ(faults.size(), 3U);
  EXPECT_EQ(faults[0].trouble, Trouble::BitErrors);
  EXPECT_FALSE(faults[0].module);
  EXPECT_EQ(faults[1].trouble, Trouble::LostReply);
  EXPECT_EQ(faults[1].module, 1U);
  EXPECT_EQ(faults[1].text, "lost-reply every 10th reply");
  EXPECT_FALSE(faults[2].module);
}

TEST(Arguments, AWrongFaultIsRefused) {
  for (const auto& [text, wrong, mend] : std::vector<std::array<const char*, 3>>{
           {"", "--fault: the fault is empty", "expected one of bit-errors"},
           {" ", "--fault: the fault is empty", "expected one of bit-errors"},
           {"1", "--fault: the fault is empty", "expected one of bit-errors"},
           {"bogus", "--fault: 'bogus' is not a fault", "expected one of bit-errors"},
           {"0 gone", "no module 0", "expected a position from 1 to 1"},
           {"2 gone", "no module 2", "expected a position from 1 to 1"},
           {"1 bit-errors 0.1", "1 bit-errors 0.1: concerns the line", "leave out the module's position"},
           {"gone at noon", "gone at noon: 'noon'", "12.5s"},
           {"gone\nat\nnoon", "gone at noon: 'noon'", "12.5s"},
       }) {
    expect_error({"EX9052D", "--fault", text}, wrong, mend);
  }
  expect_error({"EX9052D", "--fault"}, "--fault", "--help");
}

TEST(Arguments, ASeedIsAWholeNumber) {
  EXPECT_EQ(all_accepted({"EX9042D"}).seed, 1U);
  EXPECT_EQ(all_accepted({"EX9042D", "--seed", "0"}).seed, 0U);
  EXPECT_EQ(all_accepted({"EX9042D", "--seed", "18446744073709551615"}).seed, 18446744073709551615U);
  for (const char* seed : {"", "x", "1.5", "18446744073709551616", "0x10", " 1"}) {
    expect_error({"EX9042D", "--seed", seed}, "--seed: '" + std::string(seed) + "'",
                 "a whole number of at least 0");
  }
}

TEST(Arguments, TheNumberOfThreadsIsFrom1To64) {
  EXPECT_EQ(all_accepted({"EX9042D"}).threads, std::nullopt);
  EXPECT_EQ(all_accepted({"EX9042D", "--threads", "64"}).threads, 64U);
  for (const char* threads : {"0", "65", "two", ""}) {
    expect_error({"EX9042D", "--threads", threads}, "--threads: '" + std::string(threads) + "'",
                 "a whole number from 1 to 64");
  }
}

TEST(Arguments, SpeedIsMaxOrStepOrAFactorWithinLimits) {
  EXPECT_TRUE(all_accepted({"EX9042D"}).speed.paced());
  EXPECT_EQ(all_accepted({"EX9042D"}).speed.factor, 1.0);
  for (const auto& [text, speed] :
       {std::pair("0.001", 0.001), std::pair("10", 10.0), std::pair("1e3", 1000.0)}) {
    EXPECT_EQ(all_accepted({"EX9042D", "--speed", text}).speed.factor, speed);
  }
  EXPECT_TRUE(all_accepted({"EX9042D", "--speed", "max", "--for", "1s"}).speed.max());
  expect_error({"EX9042D", "--speed", "max"}, "--speed: max requires --for", "for example --for 10s");
  expect_error({"EX9042D", "--speed", "max", "--for", "1s", "--tcp", "0"},
               "--speed: max cannot be combined with --tcp, ", "leave out one of them");
  for (const char* speed :
       {"", "0", "-1", "1e-12", "0.00099", "1000.1", "1e300", "nan", "inf", "fast", "1x"}) {
    expect_error({"EX9042D", "--speed", speed}, "--speed: '" + std::string(speed) + "'",
                 "from 0.001 to 1000, max or step");
  }
}

TEST(Arguments, SteppedTimeRequiresTheControlSocketAndCannotBeCombinedWithPanelOrSerial) {
  const struct Setup setup = all_accepted({"EX9042D", "--speed", "step", "--control", "c"});
  EXPECT_TRUE(setup.speed.stepped());
  EXPECT_EQ(setup.lines[0].pty, "ex9000.tty");
  EXPECT_TRUE(all_accepted({"EX9042D", "--speed", "step", "--control", "c", "--watch"}).watch);
  expect_error({"EX9042D", "--speed", "step"}, "--speed: step", "requires --control");
  expect_error({"EX9042D", "--speed", "step", "--control", "c", "--panel"}, "--speed: step",
               "cannot be combined with --panel");
  expect_error({"EX9042D", "--speed", "step", "--control", "c", "--serial", "/dev/ttyUSB0"},
               "--speed: ", "cannot be combined with --serial");
}

TEST(Arguments, TheAccessOfAPseudoTerminalIsAModeAndAGroup) {
  EXPECT_EQ(accepted({"EX9042D", "--pty-access", "660:root"}).pty_access->mode, 0660U);
  EXPECT_EQ(accepted({"EX9042D", "--pty-access", "660:root"}).pty_access->group, 0U);
  EXPECT_FALSE(accepted({"EX9042D", "--pty-access", "622"}).pty_access->group);
  EXPECT_EQ(accepted({"EX9042D", "--pty-access", "600:4711"}).pty_access->group, 4711U);
  for (const char* wrong : {"66", "6600", "060", "0660", "460", "670", "888", ":root", "rw"}) {
    expect_error({"EX9042D", "--pty-access", wrong}, "--pty-access: ", "expected MODE[:GROUP]");
  }
  expect_error({"EX9042D", "--pty-access", "660:no-such-group"},
               "--pty-access: ", "no group 'no-such-group'");
  expect_error({"EX9042D", "--pty-access", "660:"}, "--pty-access: ", "no group ''");
  expect_error({"EX9042D", "--pty-access", "660", "--tcp", "0"},
               "--pty-access: ", "requires --pty; add --pty");
}

TEST(Arguments, AnOptionBeforeAnotherOptionRequiresItsValue) {
  expect_error({"EX9042D", "--tcp", "--for", "0.2s"},
               "--tcp: ", "the value is missing before --for; expected --tcp [HOST:]PORT");
  expect_error({"EX9042D", "--pty", "--log"},
               "--pty: ", "the value is missing before --log; expected --pty LINK");
  expect_error({"EX9042D", "--control", "--panel", "0"},
               "--control: ", "the value is missing before --panel");
  expect_error({"describe", "EX9042D", "--format", "--tcp", "0"},
               "--format: ", "the value is missing before --tcp");
  EXPECT_EQ(accepted({"EX9042D", "--pty=--odd"}).pty, "--odd");
}

TEST(Arguments, ALineFormatMayBeInLowerCase) {
  EXPECT_EQ(accepted({"EX9042D", "--format", "8e1"}).format, LineFormat::k8E1);
}

}  // namespace
}  // namespace ex9000::sim
