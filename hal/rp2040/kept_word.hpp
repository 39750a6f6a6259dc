// The word of hal/kept_word.hpp: a scratch register of the watchdog. Source: RP2040 data sheet, 4.7.6.
#pragma once

#include <cstdint>

#include "hal/rp2040/shared_register.hpp"

namespace ex9000::hal::rp2040 {

/// The second of eight; watchdog.hpp has the first. A chip-level reset clears it, one by the watchdog does
/// not.
class KeptWord {
 public:
  [[nodiscard]] static std::uint32_t load() { return kScratch.read().value(); }
  static void store(std::uint32_t value) { kScratch.write(Bits<Scratch>(value)); }

 private:
  struct Scratch;
  static constexpr SharedRegister<Scratch> kScratch{0x4005'8010};
};

}  // namespace ex9000::hal::rp2040
