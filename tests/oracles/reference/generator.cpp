#include "tests/oracles/reference/generator.hpp"

#include <optional>
#include <string>
#include <utility>

#include "tests/oracles/reference/hexadecimal.hpp"

namespace ex9000::reference {

unsigned baud_code_with(unsigned code, const Module& module, Random& random) {
  return code | (!module.has_extensions() || random.once_in(2) ? 0U : random.below(4) << 6);
}

}  // namespace ex9000::reference
