// Seeded chance that is the same everywhere.
#pragma once

#include <cstdint>
#include <random>

namespace ex9000::sim {

class Chance {
 public:
  explicit Chance(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t number() { return engine_(); }
  /// The engine's numbers are the same on every machine; what a library's distributions make of them is not.
  bool happens(double probability) {
    constexpr double kOneIn2To64 = 1.0 / 18446744073709551616.0;
    return probability > 0 && static_cast<double>(engine_()) * kOneIn2To64 < probability;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace ex9000::sim
