// The second stage of the boot sequence. The boot ROM copies the first 256 bytes of the flash to the end of
// the SRAM. If the checksum in the last four of these bytes is right, the boot ROM calls `second_stage`,
// which starts the loader. toolchain/seal-image writes the checksum. Source: RP2040 data sheet, 2.8.1.
#include <cstdint>

#include "boards/rp2040/memory.hpp"
#include "firmware/update/slot.hpp"
#include "hal/rp2040/boot.hpp"
#include "hal/rp2040/clocks.hpp"

namespace ex9000::start_up {

// Symbols of the linker script. The vector table is at `loader_begin`.
extern "C" std::uint32_t loader_begin[];
extern "C" std::uint32_t loader_end[];

extern "C" [[noreturn]] __attribute__((section(".second_stage"), used, externally_visible)) void
second_stage() {
  // Absolute symbols, with which the linker script checks its numbers.
  __asm(
      ".global loader_in_flash, slots_in_flash, slot_size, image_in_slot, image_in_ram \n"
      ".set loader_in_flash, %c0 \n"
      ".set slots_in_flash, %c1 \n"
      ".set slot_size, %c2 \n"
      ".set image_in_slot, %c3 \n"
      ".set image_in_ram, %c4" ::"i"(board::kLoaderInFlash),
      "i"(board::kSlotsInFlash), "i"(update::kSlotSize), "i"(update::kImageAt), "i"(board::kImageInRam));
  hal::rp2040::Clocks::use_reference();
  hal::rp2040::Boot::use_crystal();
  hal::rp2040::Boot::copy(board::kLoaderInFlash, loader_begin,
                          static_cast<std::uint32_t>(loader_end - loader_begin));
  hal::rp2040::Boot::jump(loader_begin);
}

}  // namespace ex9000::start_up
