// A program that runs in the emulator. It erases the flash, writes to it and reads it in an endless loop,
// while the interrupt handler of the UART receives bytes. The program runs from RAM, as the images do.
#include <array>
#include <cstdint>

#include "boards/cortex_m/start_up.hpp"
#include "boards/pico/board.hpp"
#include "hal/cortex_m/interrupts.hpp"
#include "hal/pins/single_pins.hpp"
#include "hal/pl011/uart.hpp"
#include "hal/rp2040/clocks.hpp"
#include "hal/rp2040/flash.hpp"
#include "hal/rp2040/interrupts.hpp"
#include "hal/rp2040/resets.hpp"
#include "hal/rp2040/timer.hpp"
#include "hal/rp2040/watchdog.hpp"

namespace ex9000::board {
namespace {

using namespace hal::rp2040;
using hal::cortex_m::Interrupts;

constexpr std::uint32_t kHertz = kClock.frequency();
constexpr std::uint32_t kSector = kSettingsInFlash;
constexpr std::uint32_t kOtherSector = kSector + hal::kFlashSector;
constexpr std::size_t kRecord = 32;

using LineEndTimer = OneShotTimer<1>;
using Line = hal::pl011::Uart<0x4003'4000, kHertz, hal::DriverEnablePin<kDriverEnable>, LineEndTimer>;
using Watchdog = HardwareWatchdog<kClock.crystal / 1'000'000>;

/// tests/boards/pico_flash_test.cpp reads these words. They are in a bank of RAM that contains no variables
/// of an image.
struct Results {
  std::uint32_t received;    ///< number of bytes
  std::uint32_t unexpected;  ///< number of bytes with an error, or out of sequence
  std::uint32_t rounds;      ///< number of rounds; a round erases the first sector and writes all its records
  std::uint32_t wrong;       ///< number of bytes from the flash that differ from the expected bytes
  std::uint32_t erasing;     ///< 1 during an erase, otherwise 0
  std::uint32_t reason;      ///< ResetReason
};
// NOLINTNEXTLINE(performance-no-int-to-ptr): a fixed address
volatile Results& results() { return *reinterpret_cast<volatile Results*>(0x2004'1000); }

Line line;

void on_line() {
  line.on_interrupt([](std::uint8_t byte, ByteStatus status) {
    const std::uint32_t received = results().received;
    if (status != ByteStatus::Good || byte != static_cast<std::uint8_t>(received)) {
      results().unexpected = results().unexpected + 1U;
    }
    results().received = received + 1U;
  });
}

constexpr start_up::Served kServed[] = {{static_cast<unsigned>(Interrupt::Uart0), on_line}};
__attribute__((section(".vectors"), used)) constexpr auto kVectors =
    start_up::vectors<26>(start_up::fault_handler, kServed);

void wait() {
  while (Flash::busy()) {
    Watchdog::feed();
  }
}

std::uint8_t content(std::uint32_t address) {
  return static_cast<std::uint8_t>(address * 7U + address / 256U);
}

void compare(std::uint32_t address, bool is_erased) {
  std::array<std::uint8_t, kRecord> record{};
  Flash::read(address, {record.data(), record.size()});
  for (std::size_t i = 0; i < kRecord; ++i) {
    const std::uint8_t expected = is_erased ? 0xFF : content(address + static_cast<std::uint32_t>(i));
    if (record[i] != expected) {
      results().wrong = results().wrong + 1U;
    }
  }
}

void program(std::uint32_t address) {
  std::array<std::uint8_t, kRecord> record{};
  for (std::size_t i = 0; i < kRecord; ++i) {
    record[i] = content(address + static_cast<std::uint32_t>(i));
  }
  Flash::start_program(address, {record.data(), record.size()});
  wait();
}

/// Erases the first sector. Suspends the erase once, and reads a record of the other sector while the erase
/// is suspended.
void erase() {
  results().erasing = 1;
  Flash::start_erase(kSector);
  for (int i = 0; i < 1000; ++i) {
    static_cast<void>(Flash::busy());
  }
  Flash::suspend();
  wait();
  compare(kOtherSector, false);
  Flash::resume();
  wait();
  results().erasing = 0;
}

}  // namespace
}  // namespace ex9000::board

int main() {
  using namespace ex9000;
  using namespace ex9000::board;
  const ResetReason reason = Watchdog::reset_reason();
  Watchdog::start();
  Resets::restart(Block::Pins | Block::Pads | Block::Timer);
  line.start();
  Clocks::use<kClock>();
  Resets::restart(static_cast<std::uint32_t>(Block::Uart0));
  Gpio::make_peripheral(kUartPins.mask(), Function::Uart);
  results().received = 0;
  results().unexpected = 0;
  results().rounds = 0;
  results().wrong = 0;
  results().erasing = 0;
  results().reason = static_cast<std::uint32_t>(reason);
  line.open(115200, LineFormat::k8N1);
  Interrupts::enable(start_up::numbers_of(kServed));
  Flash::start();
  wait();
  program(kOtherSector);
  for (;;) {
    erase();
    for (std::uint32_t place = kSector; place < kOtherSector; place += kRecord) {
      compare(place, true);
      program(place);
      compare(place, false);
    }
    results().rounds = results().rounds + 1U;
  }
}
