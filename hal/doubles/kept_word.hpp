#pragma once

#include <cstdint>

namespace ex9000::hal::doubles {

class KeptWord {
 public:
  [[nodiscard]] std::uint32_t load() const { return value_; }
  void store(std::uint32_t value) { value_ = value; }

 private:
  std::uint32_t value_ = 0xFFFF'FFFF;
};

}  // namespace ex9000::hal::doubles
