#include "sim/greeting.hpp"

#include <map>
#include <vector>

namespace ex9000::sim {

namespace {

/// A path that needs no quoting in a shell stays as it is.
std::string quoted(const std::string& path) {
  const std::string plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789_./-+:@%";
  if (path.find_first_not_of(plain) == std::string::npos) {
    return path;
  }
  std::string text = "'";
  for (const char character : path) {
    text += character == '\'' ? std::string("'\\''") : std::string(1, character);
  }
  return text + "'";
}

/// mbpoll counts from 1 and wants `-P none`: its own default is even parity, which a pseudo-terminal swallows
/// without a word and a real bus does not.
std::string mbpoll(const ModuleSpec& spec, const std::string& link) {
  const std::string common = "mbpoll -m rtu -a " + std::to_string(spec.address()) + " -b " +
                             std::to_string(spec.baud()) + " -P none ";
  std::string text;
  if (spec.model->has_outputs()) {
    text += "    " + common + "-t 0 -r 1 -c " + std::to_string(spec.model->outputs) + " -1 " + link +
            "    # read the outputs\n";
    text += "    " + common + "-t 0 -r 1 " + link + " 1" + "    # switch output 0 on\n";
  }
  if (spec.model->has_inputs()) {
    text += "    " + common + "-t 1 -r 1 -c " + std::to_string(spec.model->inputs) + " -1 " + link +
            "    # read the inputs\n";
    text += "    " + common + "-t 3 -r 1 -c " + std::to_string(spec.model->inputs) + " -1 " + link +
            "    # read the counters\n";
  }
  return text;
}

std::string terminal(const ModuleSpec& spec, const std::string& link) {
  return "    picocom -q -b " + std::to_string(spec.baud()) + " --imap crcrlf --echo " + link +
         "    # then type $" + hex_byte_text(spec.address()) + "M and Enter\n";
}

std::string shared_addresses(const std::vector<ModuleSpec>& modules) {
  std::map<unsigned, unsigned> users;
  for (const ModuleSpec& spec : modules) {
    ++users[spec.address()];
  }
  std::string text;
  for (const auto& [address, count] : users) {
    if (count > 1) {
      text += std::to_string(count) + " modules are at address " + hex_byte_text(address) +
              " and will answer at once; MODEL@ADDR gives them different ones\n";
    }
  }
  return text;
}

}  // namespace

std::string greeting(const Arguments& arguments, const std::string& device) {
  const std::string link = quoted(arguments.pty_link);
  std::string text = "ex9000-sim " + std::string(kFirmwareVersion) + ", line at " +
                     std::to_string(arguments.line_baud()) + " baud on " + link + " (" + device + "):\n";
  for (const ModuleSpec& spec : arguments.modules) {
    text += "  " + std::string(spec.model->designation) + " at " + hex_byte_text(spec.address()) + ", " +
            (spec.speaks_ascii() ? "ASCII" : "Modbus RTU") + ", " + std::to_string(spec.baud()) + " baud\n";
    text += spec.speaks_ascii() ? terminal(spec, link) : mbpoll(spec, link);
  }
  text += shared_addresses(arguments.modules);
  return text + "Ctrl-C ends it";
}

}  // namespace ex9000::sim
