#include "sim/text/values.hpp"
#include "sim/utility/command/send.hpp"
#include "sim/utility/master_line/master_line.hpp"
#include "sim/utility/update/session.hpp"

namespace ex9000::utility {

namespace {

bool update(Environment& environment, const sim::Words& args, const Options& options) {
  const Port port = parse_port(args.front());
  std::vector<Addressee> modules;
  for (auto word = args.begin() + 1; word != args.end() - 1; ++word) {
    modules.push_back(parse_addressee(*word));
    if (std::count_if(args.begin() + 1, args.end() - 1, [&](const auto& each) {
          return parse_addressee(each).name == modules.back().name;
        }) > 1) {
      sim::fail("'" + *word + "' is there twice; name each module once");
    }
  }
  const UpdateFile file = read_update_file(args.back());
  MasterLine line(environment, port, options.line);
  return update_modules(environment, line.modbus(), modules, file, options.wait);
}

}  // namespace

const std::vector<sim::Setting<Options>> known_options{
    {"baud", sim::Form::Choice, "1200|2400|4800|9600|19200|38400|57600|115200",
     "the rate of the line (default: 9600)",
     [](Options& taken, const std::string& value) { taken.line.baud = sim::parse_baud_rate(value); }},
    {"format", sim::Form::Choice, "8N1|8N2|8E1|8O1", "the format of the line (default: 8N1)",
     [](Options& taken, const std::string& value) { taken.line.format = sim::parse_line_format(value); }},
    {"checksum", sim::Form::Flag, "on|off", "add a checksum to DCON commands",
     [](Options& taken, const std::string& value) { taken.checksum = sim::parse_on_off(value); }},
    {"wait", sim::Form::Flag, "on|off",
     "wait until the modules have confirmed the image: 60 s after its start, if no reset has come in between",
     [](Options& taken, const std::string& value) { taken.wait = sim::parse_on_off(value); }},
};

const std::vector<Verb> verbs{
    {"send PORT REQUEST...",
     "send one request, and print it and its reply in words",
     R"(
REQUEST is a DCON command without CR, in quotes, or the bytes of a Modbus request in hex, without the CRC.
Examples: ex9000 send /dev/ttyUSB0 '$01M'
          ex9000 send modbus-tcp:10.0.0.7 01 03 0000 0008
)",
     {"baud", "format", "checksum"},
     send},
    {"update PORT MODULE... FILE",
     "send an update file to modules",
     R"(
They keep working while they receive it, and start the new image together, when all have it. What a module
has received stays: after an interruption, the same command continues.
Example: ex9000 update /dev/ttyUSB0 5 6 0D001F3A EX9042D-M.ex9fw --baud 115200 --wait
)",
     {"baud", "format", "wait"},
     update},
};

}  // namespace ex9000::utility
