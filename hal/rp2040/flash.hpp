// The flash chip, over the synchronous serial interface (SSI). Sources: RP2040 data sheet, 4.10 (SSI),
// 2.19.6.2 (pins of the flash); W25Q16JV data sheet, 8.1 and 8.2 (instructions).
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "hal/flash.hpp"
#include "hal/registers/register.hpp"
#include "hal/rp2040/shared_register.hpp"

namespace ex9000::hal::rp2040 {

/// Uses standard SPI commands, one data line per direction, while the image runs from RAM. Contract:
/// hal/flash.hpp. Interrupts stay enabled: the driver controls chip select itself, so a delay between two
/// bytes is harmless. After `start`, the flash is not mapped into memory. A byte that `read` returns takes
/// 0.3 us, any other up to 0.6 us; a command with its address has four bytes.
class Flash {
 public:
  /// Once, first. Resumes a suspended operation; a reset of the MCU ends none, so the flash may be busy.
  static void start() {
    open();
    resume();  // has no effect if nothing is suspended
  }
  /// Instead of `start`, leaves a suspended operation as it is. The other functions can then be called.
  static void open() {
    constexpr std::uint32_t kDivider = 4;  // must be even; 125 MHz / 4 = 31.25 MHz; Read Data allows 50 MHz
    constexpr Bits<Control> kBytesBothWays(7U << 16U);
    select(false);
    kEnable.write({});
    kBaud.write(Bits<Baud>(kDivider));
    kControl.write(kBytesBothWays);
    kSlave.write(Bits<Slave>(1));
    kEnable.write(Bits<Enable>(1));
  }

  /// The number that no other chip has. Call it before `start`, because a busy flash does not answer.
  static std::array<std::uint8_t, 8> unique_id() {
    constexpr unsigned kDummies = 4;
    std::array<std::uint8_t, 8> id{};
    open();
    select(true);
    exchange(kReadUniqueId);
    for (unsigned i = 0; i < kDummies; ++i) {
      exchange(0);
    }
    for (std::uint8_t& byte : id) {
      byte = exchange(0);
    }
    select(false);
    return id;
  }

  static void start_erase(std::uint32_t address) {
    command(kWriteEnable);
    address_command(kSectorErase, address);
    select(false);
  }

  static void start_program(std::uint32_t address, Bytes bytes) {
    command(kWriteEnable);
    address_command(kPageProgram, address);
    for (std::size_t i = 0; i < bytes.size; ++i) {
      exchange(bytes[i]);
    }
    select(false);
  }

  [[nodiscard]] static bool busy() {
    select(true);
    exchange(kReadStatus);
    const std::uint8_t status = exchange(0);
    select(false);
    return (status & kBusyBit) != 0;
  }

  static void suspend() { command(kSuspend); }
  static void resume() { command(kResume); }

  static void read(std::uint32_t address, MutableBytes destination) {
    constexpr std::size_t kMostInTransit = 8;  // the queues have room for 16 bytes
    address_command(kReadData, address);
    std::size_t requested = 0;
    for (std::size_t i = 0; i < destination.size; ++i) {
      for (; requested < destination.size && requested - i < kMostInTransit; ++requested) {
        kData.write({});
      }
      destination.data[i] = take();
    }
    select(false);
  }

 private:
  struct Control;
  struct Enable;
  struct Slave;
  struct Baud;
  struct Status;
  struct Data;
  struct SelectControl;
  static constexpr std::uint32_t kBase = 0x1800'0000U;
  static constexpr Register<Control> kControl{kBase + 0x00};
  static constexpr Register<Enable> kEnable{kBase + 0x08};
  static constexpr Register<Slave> kSlave{kBase + 0x10};
  static constexpr Register<Baud> kBaud{kBase + 0x14};
  static constexpr Register<Status> kStatus{kBase + 0x28};
  static constexpr Register<Data> kData{kBase + 0x60};
  static constexpr SharedRegister<SelectControl> kSelectControl{0x4001'800C};

  static constexpr std::uint8_t kPageProgram = 0x02;
  static constexpr std::uint8_t kReadData = 0x03;
  static constexpr std::uint8_t kReadStatus = 0x05;
  static constexpr std::uint8_t kWriteEnable = 0x06;
  static constexpr std::uint8_t kSectorErase = 0x20;
  static constexpr std::uint8_t kReadUniqueId = 0x4B;
  static constexpr std::uint8_t kSuspend = 0x75;
  static constexpr std::uint8_t kResume = 0x7A;
  static constexpr std::uint8_t kBusyBit = 0x01;

  /// The SSI itself would release chip select whenever its queue is empty.
  static void select(bool on) {
    constexpr Bits<SelectControl> kLow(0x2U << 8U);
    constexpr Bits<SelectControl> kHigh(0x3U << 8U);
    kSelectControl.write(on ? kLow : kHigh);
    (void)kSelectControl.read();  // completes the write before the next access to the SSI
  }

  static std::uint8_t exchange(std::uint8_t byte) {
    kData.write(Bits<Data>(byte));
    return take();
  }

  static std::uint8_t take() {
    constexpr Bits<Status> kReceived(1U << 3U);
    while (!kStatus.read().has(kReceived)) {
    }
    return static_cast<std::uint8_t>(kData.read().value());
  }

  static void command(std::uint8_t code) {
    select(true);
    exchange(code);
    select(false);
  }

  /// Leaves the chip selected.
  static void address_command(std::uint8_t code, std::uint32_t address) {
    select(true);
    exchange(code);
    exchange(static_cast<std::uint8_t>(address >> 16U));
    exchange(static_cast<std::uint8_t>(address >> 8U));
    exchange(static_cast<std::uint8_t>(address));
  }
};

}  // namespace ex9000::hal::rp2040
