// The reason why the reference refuses an ASCII command: wire.md 3.
#pragma once

#include <string>

namespace ex9000::reference {

/// The module refuses the command, for example because the command does not exist on this model, because its
/// arguments have a wrong format or range, or because the configuration permission is missing. Nothing
/// changes, and the reply is `?AA` or, with `bare`, `?`.
struct Refused {
  std::string reason;
  bool bare = false;
};

}  // namespace ex9000::reference
