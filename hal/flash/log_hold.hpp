// What the log of the settings must not do, because its flash does something else.
#pragma once

#include <cstdint>

namespace ex9000::hal::flash {

enum class Hold : std::uint8_t {
  Nothing,     ///< the log has the flash
  Erases,      ///< an erase that is not the log's is suspended
  Everything,  ///< an operation that is not the log's is running
};

}  // namespace ex9000::hal::flash
