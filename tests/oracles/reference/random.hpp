// Random numbers that are the same on every platform. The C++ standard specifies the numbers of its engines,
// but not those of its distributions, so this file uses no distribution.
#pragma once

#include <cstdint>
#include <random>
#include <vector>

namespace ex9000::reference {

class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// Returns a number from 0 to `count` - 1.
  unsigned below(unsigned count) { return static_cast<unsigned>(engine_() % count); }
  unsigned between(unsigned lowest, unsigned highest) { return lowest + below(highest - lowest + 1); }
  /// Returns true once in `times` calls on average.
  bool once_in(unsigned times) { return below(times) == 0; }
  template <typename T>
  T one_of(std::initializer_list<T> values) {
    return values.begin()[below(static_cast<unsigned>(values.size()))];
  }

 private:
  std::mt19937_64 engine_;
};

}  // namespace ex9000::reference
