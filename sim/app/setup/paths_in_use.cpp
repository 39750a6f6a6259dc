#include "sim/app/setup/paths_in_use.hpp"

#include <sys/stat.h>

#include <optional>

#include "sim/files_and_ports/files/one_spelling.hpp"
#include "sim/text/fail.hpp"

namespace ex9000::sim {

namespace {

/// By inode, or by path if at least one of the files does not exist.
bool are_one(const std::string& a, const std::string& b) {
  struct stat of_a {};
  struct stat of_b {};
  if (stat(a.c_str(), &of_a) == 0 && stat(b.c_str(), &of_b) == 0) {
    return of_a.st_dev == of_b.st_dev && of_a.st_ino == of_b.st_ino;
  }
  return one_spelling(a) == one_spelling(b);
}

}  // namespace

std::vector<InUse> in_use_by(const Setup& setup) {
  std::vector<InUse> all;
  const auto add = [&all](const std::string& what, const std::optional<std::string>& path) {
    if (path && !path->empty()) {
      all.push_back({what, *path});
    }
  };
  add("the bus file", setup.file);
  add("the control socket", setup.control);
  for (const LineSetup& line : setup.lines) {
    for (const PortSetup& port : line.ports) {
      add("the port", port.path);
    }
    for (const ModuleSpec& module : line.modules) {
      add("a module's EEPROM file", module.eeprom);
    }
  }
  return all;
}

void refuse_overwriting(const std::string& capture, const std::vector<InUse>& others) {
  for (const InUse& other : others) {
    if (are_one(capture, other.path)) {
      fail(capture + ": is " + other.what + " " + other.path +
           ", which the capture would overwrite; name another path");
    }
  }
}

}  // namespace ex9000::sim
