// Copies an image from the flash to RAM and jumps to it. Sources: RP2040 data sheet, 2.8.1 (boot sequence),
// 4.10 (SSI); W25Q16JV data sheet, 8.2 (Read Data); ARMv6-M Architecture Reference Manual, B3.2.5 (VTOR).
#pragma once

#include <cstdint>

#include "hal/registers/register.hpp"
#include "hal/rp2040/crystal.hpp"

namespace ex9000::hal::rp2040 {

/// For the second stage of the boot sequence only: all is inlined, because the image is not in RAM yet.
class Boot {
 public:
  /// For the reference clock: the ring oscillator may run at less than 2 MHz. Blocks about 5 ms at most if
  /// the crystal starts. If it is not stable after `kMostReads` reads, the clock stays as it is: the image
  /// then starts the watchdog and waits for the crystal.
  [[gnu::always_inline]] static void use_crystal() {
    constexpr unsigned kMostReads = 20'000;  // a read takes at least 0.5 us
    Crystal::start();
    for (unsigned read = 0; read < kMostReads; ++read) {
      if (Crystal::stable()) {
        Crystal::make_reference();
        return;
      }
    }
  }

  /// `words`: 1 to 65,536, in 64 clocks of the processor each: 5.3 us with a crystal of 12 MHz. The command
  /// Read Data (03h) needs no configuration of the flash: the boot ROM reads the second stage with it.
  [[gnu::always_inline]] static void copy(std::uint32_t address, std::uint32_t* destination,
                                          std::uint32_t words) {
    constexpr std::uint32_t kReadData = 0x03;
    constexpr Bits<Control> kWordsAfterCommand(31U << 16U | 0x3U << 8U);  // mode "EEPROM read"
    constexpr Bits<Status> kReceived(1U << 3U);
    kSelectControl.write({});  // the SSI controls chip select
    kEnable.write({});
    kBaud.write(Bits<Baud>(2));
    kControl.write(kWordsAfterCommand);
    kCount.write(Bits<Count>(words - 1U));
    kSlave.write(Bits<Slave>(1));
    kEnable.write(Bits<Enable>(1));
    kData.write(Bits<Data>(kReadData << 24U | address));
    for (std::uint32_t* const end = destination + words; destination != end; ++destination) {
      while (!kStatus.read().has(kReceived)) {
      }
      *destination = __builtin_bswap32(kData.read().value());  // the first byte is the most significant one
    }
  }

  [[noreturn, gnu::always_inline]] static void jump(const std::uint32_t* vectors) {
    kVectors.write(Bits<Vectors>(static_cast<std::uint32_t>(reinterpret_cast<std::uintptr_t>(vectors))));
    // NOLINTNEXTLINE(performance-no-int-to-ptr): the table contains the address of the reset handler
    const auto reset_handler = reinterpret_cast<void (*)()>(vectors[1]);
    __asm volatile("msr msp, %0" : : "r"(vectors[0]) : "memory");
    reset_handler();
    __builtin_unreachable();
  }

 private:
  struct Control;
  struct Count;
  struct Enable;
  struct Slave;
  struct Baud;
  struct Status;
  struct Data;
  struct SelectControl;
  struct Vectors;
  static constexpr Register<Control> kControl{0x1800'0000};
  static constexpr Register<Count> kCount{0x1800'0004};
  static constexpr Register<Enable> kEnable{0x1800'0008};
  static constexpr Register<Slave> kSlave{0x1800'0010};
  static constexpr Register<Baud> kBaud{0x1800'0014};
  static constexpr Register<Status> kStatus{0x1800'0028};
  static constexpr Register<Data> kData{0x1800'0060};
  static constexpr Register<SelectControl> kSelectControl{0x4001'800C};
  static constexpr Register<Vectors> kVectors{0xE000'ED08};
};

}  // namespace ex9000::hal::rp2040
