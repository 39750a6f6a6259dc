// Looks for all modules of a line.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/utility/device/find.hpp"

namespace ex9000::utility {

/// Where to look.
struct Search {
  std::vector<hal::SerialMode> modes;
  Speaks speaks = Speaks::Unknown;  ///< Unknown: both
  bool fast = false;                ///< only the bus scan by serial numbers
  std::uint8_t first = 0;
  std::uint8_t last = 255;
  Time patience{};  ///< for a reply
};

struct FoundModule {
  std::optional<hal::SerialMode> mode;  ///< nullopt: that of a gateway, which does not tell it
  Speaks speaks = Speaks::Unknown;
  std::uint8_t address = 0;
  bool checksum = false;
  bool garbled = false;  ///< no frame, only bytes: several modules at this address, or noise
  Identity identity;
  std::string last_reset;                      ///< empty: unknown
  std::optional<std::uint8_t> stored_address;  ///< of a module in INIT mode
};

/// All modes that modules have, the most likely ones first. A module in 8N2 understands 8N1.
std::vector<hal::SerialMode> all_modes();

/// Calls `found` for each module at once, and `progress`. Changes nothing in the modules, and clears nothing;
/// with register 0x0251 = 1, requests to a module restart its host watchdog. Throws what Connection throws.
void scan(MasterLine& line, const Search& search, const std::function<void(const FoundModule& module)>& found,
          const std::function<void(std::size_t done, std::size_t of)>& progress);

}  // namespace ex9000::utility
