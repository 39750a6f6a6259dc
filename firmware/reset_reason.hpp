// Why a module was reset.
#pragma once

#include <cstdint>

namespace ex9000 {

/// The values of register 0x0301 (wire.md section 12).
enum class ResetReason : std::uint8_t {
  Unknown,  ///< the board cannot know
  PowerOn,
  ModuleWatchdog,
  Software,
  ResetPin,
  Fault,  ///< of the processor
};

}  // namespace ex9000
