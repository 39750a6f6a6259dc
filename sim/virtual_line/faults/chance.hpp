// Seeded random numbers, the same on every platform.
#pragma once

#include <cstdint>
#include <random>

namespace ex9000::sim {

class Chance {
 public:
  explicit Chance(std::uint64_t seed) : engine_(seed) {}

  std::uint64_t number() { return engine_(); }
  /// Takes the engine's numbers directly: the standard library's distributions may differ between platforms.
  bool happens(double probability) {
    constexpr double kOneIn2To64 = 1.0 / 18446744073709551616.0;
    return probability > 0 && static_cast<double>(engine_()) * kOneIn2To64 < probability;
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace ex9000::sim
