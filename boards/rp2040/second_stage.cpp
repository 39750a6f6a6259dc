// The second stage of the boot sequence. The boot ROM copies the first 256 bytes of the flash to the end of
// the SRAM. If the checksum in the last four of these bytes is right, the boot ROM calls `second_stage`.
// toolchain/seal-second-stage writes the checksum. Source: RP2040 data sheet, 2.8.1.
#include <cstdint>

#include "hal/rp2040/boot.hpp"
#include "hal/rp2040/clocks.hpp"

namespace ex9000::start_up {

// Symbols of the linker script. The vector table is at `image_begin`.
extern "C" std::uint32_t image_begin[];
extern "C" std::uint32_t image_end[];

extern "C" [[noreturn]] __attribute__((section(".second_stage"), used, externally_visible)) void
second_stage() {
  constexpr std::uint32_t kImageInFlash = 256;
  hal::rp2040::Clocks::use_reference();
  hal::rp2040::Boot::use_crystal();
  hal::rp2040::Boot::copy(kImageInFlash, image_begin, static_cast<std::uint32_t>(image_end - image_begin));
  hal::rp2040::Boot::jump(image_begin);
}

}  // namespace ex9000::start_up
