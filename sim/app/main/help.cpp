#include "sim/app/main/help.hpp"

#include "sim/front_ends/control_socket/control.hpp"
#include "sim/notation/fault_notation.hpp"

namespace ex9000::sim::help {

namespace {

constexpr const char* kModuleHelp = R"(
A module is MODEL[@ADDR][,KEY=VALUE]... MODEL is a name from --models, in upper or lower case, with or without EX.
ADDR is the address in hex, as in `$AA2` (default: 01). The keys:
  protocol=ascii|modbus    sets the protocol (default: modbus for -M models, else ascii)
  baud=RATE                sets the baud rate: 1200, 2400, 4800, 9600, 19200, 38400, 57600 or 115200
  format=FORMAT            sets the line format: 8N1, 8N2, 8E1 or 8O1
  checksum=on|off          switches the checksum of ASCII frames on or off
  edge=falling|rising      sets the edge that the counters count
  name=TEXT                sets the name that `$AAM` reads
  init=on|off              `on` ties INIT* to GND: ASCII at address 00, 9600 baud
  eeprom=FILE              keeps the settings in this file; an existing file overrides ADDR and the
                           other keys, except init

A bus file, BUS.json, takes the place of the modules and describes any number of lines. --example prints an example,
--schema prints the JSON Schema. Options that describe a line, for example --tcp and --fault, cannot be combined with
a bus file.

Commands of the control socket: each is one line of text, with the reply `ok ...` or `error: ...`. N is the position
of a module. Positions count from 1, on the command line or through all lines of the bus file:
)";

constexpr const char* kPlayHelp = R"(
A file is a list of steps: `> $01M` and `< !019042D` for DCON, `=> 01 01 0000 000D` and `<= ...` for Modbus
frames without the CRC, `silence`, `wait 1.5s`, `bytes HEX`, `checksum on|off`, `baud RATE`, `format FORMAT`, and for
a module `power on|off`, `power-cycle`, `reset`, `init on|off`, `input C on|off`, `pulse C [xCOUNT]`, `outputs HHHH`,
`led on|off|flashing`.
A file with `source:` and `model:` lines before the steps is a transcript, which is played on each of these models. A
file without `model:` lines is a scenario for the modules or the bus file on the command line. A scenario can
have more steps: `module N`, `line NAME`, `fault [N] FAULT` as for --fault, and `fault off K|all`. See
tests/conformance/README.md.
)";

constexpr const char* kFaultHelp = R"(
A fault is TROUBLE [VALUE] [WHEN], for --fault, for bus files and for the control socket. For --fault, write N
before a fault of one module. The troubles:
)";

constexpr const char* kScheduleHelp = R"(
  WHEN is one of: at 12.5s | every 5s | every reply | every 10th reply |
  with probability 0.01 (for each reply) | after 3 writes (to the EEPROM).
  Without WHEN the fault begins immediately and stays active; power-cut, foreign-traffic and hang
  then occur once. `for 2s` limits how long the fault lasts.
  Faults follow the time of the line, which is the time in the log. The units of time are us, ms, s, min and h.

The description of an input that changes by itself is C square PERIOD [for TIME] [bounce TIME] or
C key at TIME|every TIME for TIME [bounce TIME], for --input and for bus files. For --input, write N before it.
)";

constexpr const char* kDescribeExamples = R"(
Examples:
  ex9000-sim describe EX9042D-M
  ex9000-sim describe EX9042D-M --format home-assistant --address 0A > modbus.yaml)";

constexpr const char* kExamples = R"(
Examples:
  ex9000-sim EX9042D-M@01 EX9052D-M@02,edge=rising 9068d-m@0A,protocol=ascii --log
  ex9000-sim EX9042D-M@01,eeprom=pump.bin --tcp 5020 --control pump.ctl
  ex9000-sim EX9042D-M@01 EX9052D-M@02 --modbus-tcp 1502 --panel
  ex9000-sim EX9052D@01 --watch --input '1 3 square 2s'
  ex9000-sim EX9042D-M@01 --capture line.pcapng --log json > line.json
  ex9000-sim EX9052D@01 --input '1 0 square 100ms' --fault '1 lost-reply every 10th reply' --log
  ex9000-sim EX9042D-M@01 --tcp 5020 --control test.ctl --speed step
  ex9000-sim --example > bus.json && ex9000-sim bus.json
The baud rate that a master sets on the pseudo-terminal becomes the baud rate of
the line. A pseudo-terminal carries no parity.)";

}  // namespace

std::string of_the_program() {
  return kModuleHelp + control_commands() + kFaultHelp + fault_help() + kScheduleHelp + kExamples;
}

std::string of_play() { return kPlayHelp; }

std::string of_describe() { return kDescribeExamples; }

}  // namespace ex9000::sim::help
