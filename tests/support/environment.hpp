// Reads the environment variables that control long runs.
#pragma once

#include <cstdint>
#include <cstdlib>
#include <stdexcept>
#include <string>

namespace ex9000 {

/// Returns the value of `variable`, or `otherwise` if the variable is not set. Throws std::runtime_error if
/// the value is not a decimal number of up to 18 digits, so that a mistake does not replace a long run by a
/// short one.
inline std::uint64_t number_in_environment(const char* variable, std::uint64_t otherwise) {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): no caller uses setenv
  const char* const text = std::getenv(variable);
  if (text == nullptr) {
    return otherwise;
  }
  const std::string digits = text;
  if (digits.empty() || digits.size() > 18 || digits.find_first_not_of("0123456789") != std::string::npos) {
    throw std::runtime_error(std::string(variable) + "=" + digits +
                             ": wrong value; expected up to 18 decimal digits");
  }
  return std::stoull(digits);
}

/// Returns whether the test must run all cases, and not only some cases: true if the environment variable
/// EX9000_CUTS is `all`, false if EX9000_CUTS is not set. Throws std::runtime_error if EX9000_CUTS has
/// another value.
inline bool all_cases_requested() {
  // NOLINTNEXTLINE(concurrency-mt-unsafe): no caller uses setenv
  const char* const which = std::getenv("EX9000_CUTS");
  if (which != nullptr && std::string(which) != "all") {
    throw std::runtime_error(
        "EX9000_CUTS=" + std::string(which) +
        ": unknown value; set EX9000_CUTS=all for all cases, or do not set EX9000_CUTS for some cases");
  }
  return which != nullptr;
}

}  // namespace ex9000
