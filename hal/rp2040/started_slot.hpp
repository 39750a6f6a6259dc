// The slot of the running image: the loader tells it in a scratch register. Source: RP2040 data sheet, 4.7.6.
#pragma once

#include <cstdint>

#include "hal/rp2040/shared_register.hpp"

namespace ex9000::hal::rp2040 {

/// The third of eight; kept_word.hpp has the second.
class StartedSlot {
 public:
  /// 0 if no loader has started this image.
  [[nodiscard]] static unsigned load() {
    const std::uint32_t value = kScratch.read().value();
    return (value & ~kSlot) == kByLoader ? value & kSlot : 0;
  }
  static void store(unsigned slot) { kScratch.write(Bits<Scratch>(kByLoader | slot)); }

 private:
  struct Scratch;
  static constexpr SharedRegister<Scratch> kScratch{0x4005'8014};
  static constexpr std::uint32_t kSlot = 0x1;
  static constexpr std::uint32_t kByLoader = 0x4558'0100;  ///< any value that other software does not write
};

}  // namespace ex9000::hal::rp2040
