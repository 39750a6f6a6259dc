// Who may open a pseudo-terminal.
#pragma once

#include <sys/types.h>

#include <optional>
#include <string>

namespace ex9000::sim {

struct PtyAccess {
  mode_t mode = 0;             ///< for example 0660; the owner can always read and write
  std::optional<gid_t> group;  ///< nullopt: the group that the system has chosen
};

/// `MODE[:GROUP]`, such as 660:dialout: 6, then twice 0, 2, 4 or 6; a name in /etc/group or a number.
PtyAccess parse_pty_access(const std::string& text);

}  // namespace ex9000::sim
