#include "sim/files_and_ports/ports/pty_access.hpp"

#include <fstream>
#include <limits>
#include <sstream>

#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

/// Reads /etc/group: the C library would require shared libraries, which the static program does not have.
std::optional<gid_t> group_called(const std::string& name) {
  std::ifstream groups("/etc/group");
  for (std::string line; std::getline(groups, line);) {
    std::istringstream fields(line);
    std::string known;
    std::string password;
    std::string number;
    std::getline(fields, known, ':');
    std::getline(fields, password, ':');
    std::getline(fields, number, ':');
    if (known == name) {
      if (const auto id = whole_number(number, std::numeric_limits<gid_t>::max() - 1)) {
        return static_cast<gid_t>(*id);
      }
    }
  }
  return std::nullopt;
}

}  // namespace

PtyAccess parse_pty_access(const std::string& text) {
  constexpr unsigned kBits = 3;
  const auto colon = text.find(':');
  const std::string mode = text.substr(0, colon);
  if (mode.size() != 3 || mode[0] != '6' || mode.find_first_not_of("0246") != std::string::npos) {
    fail("'" + text +
         "': expected MODE[:GROUP], for example 660:dialout; MODE is 600 to 666 without 1, 3 and 5");
  }
  PtyAccess access;
  for (const char digit : mode) {
    access.mode = access.mode << kBits | static_cast<mode_t>(digit - '0');
  }
  if (colon != std::string::npos) {
    const std::string group = text.substr(colon + 1);
    access.group = group_called(group);
    if (const auto number = whole_number(group, std::numeric_limits<gid_t>::max() - 1);
        !access.group && number) {
      access.group = static_cast<gid_t>(*number);
    }
    if (!access.group) {
      fail("'" + text + "': no group '" + group +
           "' in /etc/group; expected a name in /etc/group or a number");
    }
  }
  return access;
}

}  // namespace ex9000::sim
