// Why a module was reset.
#pragma once

#include <cstdint>

namespace ex9000 {

/// The values of register 0x0301 (firmware/extensions.md).
enum class ResetReason : std::uint8_t {
  Unknown,  ///< the board cannot detect the reason
  PowerOn,
  ModuleWatchdog,
  Software,
  ResetPin,
  Fault,  ///< a fault of the processor, or an unexpected interrupt
};

}  // namespace ex9000
