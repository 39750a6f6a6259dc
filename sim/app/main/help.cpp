#include "sim/app/main/help.hpp"

#include "sim/app/setup/port_setup.hpp"
#include "sim/notation/actions.hpp"
#include "sim/notation/fault_notation.hpp"
#include "sim/notation/module_settings.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/help_row.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim::help {

namespace {

std::string of_modules() {
  std::string text =
      "A module is MODEL[@ADDR][,KEY=VALUE]..., for example 9052d-m@0A,edge=rising. MODEL is a name from\n"
      "--models, in upper or lower case, with or without EX. ADDR is the address in hex (default: 01).\n\n";
  for (const Setting<ModuleSpec>& setting : module_settings) {
    text += help_row(std::string(setting.name) + "=" + std::string(setting.value), setting.does, kColumn);
  }
  return text;
}

std::string of_ports() {
  return "A port is KIND:WHERE[,OPTION[=VALUE]]... A line may have several. Without one, the program "
         "creates\n"
         "the pseudo-terminal ex9000.tty. HOST is 127.0.0.1 by default; the port 0 is any free port.\n\n" +
         port_help();
}

std::string of_inputs() {
  return "An input that changes by itself:\n\n"
         "  C square PERIOD [for TIME] [bounce TIME]               for TIME: how long it is on\n"
         "  C key at TIME|every TIME for TIME [bounce TIME]        a key press\n\n"
         "C is the channel, from 0; for example EX9052D@01,input=0 square 100ms\n";
}

std::string of_faults() {
  return "A fault is KIND [VALUE] [WHEN] [for TIME].\n\n" + fault_help() +
         "\n"
         "WHEN is one of: at 12.5s | every 5s | after 3 writes (to the EEPROM), and for a fault of a module "
         "also\n"
         "every reply | every 10th reply | with probability 0.01 (for each reply).\n"
         "Without WHEN the fault begins immediately and stays active; power-cut, foreign-traffic and hang\n"
         "then occur once. `for 2s` limits how long the fault lasts.\n"
         "Faults follow the time of the line. The units of time are us, ms, s, min and h.\n";
}

std::string of_control() {
  return "Each command on the control socket is one line of text, with the reply `ok ...` or `error: ...`.\n"
         "N is the position of a module. Positions count from 1, through all lines.\n\n" +
         action_help();
}

struct Topic {
  const char* name;
  std::string (*text)();
};

constexpr Topic kTopics[] = {{"modules", of_modules}, {"ports", of_ports},     {"inputs", of_inputs},
                             {"faults", of_faults},   {"control", of_control}, {"steps", of_play}};

}  // namespace

const char* const examples = R"(
Examples:
  ex9000-sim EX9042D-M@01 EX9052D-M@02 --log
  ex9000-sim EX9042D-M@01,eeprom=pump.bin --port tcp:5020 --control pump.ctl
  ex9000-sim EX9042D-M@01 --port modbus-tcp:1502 --panel
  ex9000-sim 'EX9052D@01,input=0 square 100ms,fault=lost-reply every 10th reply' --log
  ex9000-sim --example > bus.yaml && ex9000-sim bus.yaml)";

std::string of_play() {
  return R"(A file is a list of steps: `> $01M` and `< !019042D` for DCON, `=> 01 01 0000 000D` and `<= ...` for Modbus
frames without the CRC, `silence`, `wait 1.5s`, `bytes HEX`, `checksum on|off`, `baud RATE`, `format FORMAT`, and for
a module `power on|off`, `power-cycle`, `reset`, `init on|off`, `input C on|off`, `pulse C [xCOUNT]`, `outputs HHHH`,
`led on|off|flashing`.
A file with `source:` and `model:` lines before the steps is a transcript, which is played on each of these models. A
file that names no models is a scenario for the modules or the bus file on the command line. A scenario can have more
steps: `module N`, `line NAME`, `fault FAULT`, `fault off K|all`, and `N COMMAND` of 'help control'. See
tests/conformance/README.md.
)";
}

std::string topics() { return names_of(kTopics, "|"); }

std::string on(const std::string& topic) {
  for (const Topic& each : kTopics) {
    if (topic == each.name) {
      return each.text();
    }
  }
  fail("help: '" + topic + "' is not a topic; expected one of " + topics());
}

}  // namespace ex9000::sim::help
