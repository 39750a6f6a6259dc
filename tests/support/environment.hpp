// What a long run is told through its environment.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace ex9000 {

/// What `variable` says, or `otherwise` where it is not set. Throws std::runtime_error where it is no decimal
/// number: a run that is shorter than it was meant to be must not pass for a long one.
inline std::uint64_t number_in_environment(const char* variable, std::uint64_t otherwise) {
  const char* const text = std::getenv(variable);  // NOLINT(concurrency-mt-unsafe): tests set none
  if (text == nullptr) {
    return otherwise;
  }
  const std::string digits = text;
  if (digits.empty() || digits.size() > 18 || digits.find_first_not_of("0123456789") != std::string::npos) {
    throw std::runtime_error(std::string(variable) + "=" + digits + " is no number of up to 18 digits");
  }
  return std::stoull(digits);
}

/// Whether EX9000_CUTS=all asks for all there is to try instead of some of it; not set, it does not. Throws
/// std::runtime_error where it says anything else, for the reason above.
inline bool all_of_them() {
  const char* const which = std::getenv("EX9000_CUTS");  // NOLINT(concurrency-mt-unsafe): tests set none
  if (which != nullptr && std::string(which) != "all") {
    throw std::runtime_error("EX9000_CUTS=" + std::string(which) +
                             ": write EX9000_CUTS=all, or leave it out for the short form");
  }
  return which != nullptr;
}

}  // namespace ex9000
