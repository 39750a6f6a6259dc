// The reason to refuse an ASCII command of the reference: wire.md 3.
#pragma once

#include <string>

namespace ex9000::reference {

/// The module refuses the command, for example because the command does not exist on this model, because its
/// arguments have a wrong format or range, or because it requires INIT*. Nothing changes, and the reply is
/// `?AA` or, with `bare`, `?`.
struct Refused {
  std::string rule;
  bool bare = false;
};

}  // namespace ex9000::reference
