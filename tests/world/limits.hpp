// What wire.md permits in time.
#pragma once

#include "tests/oracles/reference/module.hpp"

namespace ex9000::world {

using reference::kLate;
using reference::Time;

inline constexpr Time kNever = Time::max();
/// Later than anything, and has no limit.
inline constexpr Time kSometime = Time::max() / 2;
/// The limits of silences are exact to this (D11).
inline constexpr std::chrono::microseconds kExact{15};
inline constexpr std::chrono::milliseconds kReplies{20};
inline constexpr std::chrono::milliseconds kStores{200};
/// D15
inline constexpr std::chrono::milliseconds kRetry{1000};
inline constexpr std::chrono::milliseconds kModuleWatchdog{1600};
/// wire.md 2: a life that ends a row of crashes, and how much later the main loop notices it.
inline constexpr std::chrono::seconds kEndsTheRow{60};
inline constexpr std::chrono::milliseconds kNoticesIt{2000};
inline constexpr unsigned kResetByWatchdog = 2;
// extensions.md, firmware update
inline constexpr unsigned kResetByUpdate = 3;
inline constexpr std::chrono::milliseconds kActivates{100};
inline constexpr std::chrono::milliseconds kWaitsForErase{400};
inline constexpr std::chrono::seconds kProvesItself{60};
/// The specification does not limit these: how much later an image is confirmed, and how long after the reply
/// to a begin its erase takes.
inline constexpr std::chrono::milliseconds kConfirms{1000};
inline constexpr std::chrono::milliseconds kErases{1000};
/// D13
inline constexpr std::chrono::milliseconds kInitSettled{10};
inline constexpr std::chrono::milliseconds kInitTaken{20};

}  // namespace ex9000::world
