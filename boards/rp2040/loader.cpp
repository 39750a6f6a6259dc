// The loader: copies the image of a slot to RAM and starts it. The second stage has copied it to RAM, where
// nothing else is (loader_memory.ld). No update writes it.
//
// If no image may start, the loader tries for ever, with the outputs off.
#include <cstdint>
#include <optional>

#include "board.hpp"
#include "boards/rp2040/memory.hpp"
#include "firmware/update/boot.hpp"
#include "hal/rp2040/boot.hpp"
#include "hal/rp2040/clocks.hpp"
#include "hal/rp2040/flash.hpp"
#include "hal/rp2040/started_slot.hpp"
#include "hal/rp2040/watchdog.hpp"

namespace ex9000::start_up {

extern "C" {

/// The linker script defines this symbol.
extern std::uint32_t stack_top[];

[[noreturn]] void load();

}  // extern "C"

namespace {

using namespace hal::rp2040;
using Watchdog = HardwareWatchdog<board::kClock.crystal / 1'000'000>;

struct Vectors {
  const void* stack_top;
  void (*reset)();
  void (*non_maskable)();
  void (*hard_fault)();
};
__attribute__((section(".vectors"), used)) constexpr Vectors kVectors{
    stack_top, load, WatchdogRegisters::reset_chip, WatchdogRegisters::reset_chip};

constexpr std::uint32_t address_of(unsigned slot) { return board::kSlotsInFlash + slot * update::kSlotSize; }

// NOLINTNEXTLINE(performance-no-int-to-ptr): the place where all images run
std::uint32_t* image() { return reinterpret_cast<std::uint32_t*>(board::kImageInRam); }

/// For update::choose.
struct Slots {
  static update::SlotHead head(unsigned slot) {
    update::SlotHead head;
    Flash::read(address_of(slot), {head.data(), head.size()});
    return head;
  }

  static bool load(unsigned slot, const update::Info& info) {
    const std::uint32_t length = info.length();
    if (length == 0 || length > update::kLargestImage) {
      return false;
    }
    auto* const to = reinterpret_cast<std::uint8_t*>(image());
    Flash::read(address_of(slot) + update::kImageAt, {to, length});
    return update::crc32({to, length}) == info.check();
  }

  /// An erase may be suspended since before the reset: elsewhere, the flash can be programmed.
  static bool mark_tried(unsigned slot) {
    constexpr std::uint32_t kMark = update::kMarksAt + update::kTried;
    std::uint8_t mark = update::kMarked;
    Flash::start_program(address_of(slot) + kMark, {&mark, 1});
    while (Flash::busy()) {
    }
    Flash::read(address_of(slot) + kMark, {&mark, 1});
    return mark == update::kMarked;
  }
};

}  // namespace

/// With the PLL, because copy and CRC take the time of a start.
extern "C" __attribute__((externally_visible)) void load() {
  Watchdog::start_countdown();
  Clocks::use<board::kClock>();
  Flash::open();
  Slots slots;
  std::optional<unsigned> chosen;
  while (!chosen) {
    chosen = update::choose(slots);
  }
  StartedSlot::store(*chosen);
  Clocks::use_reference();  // the image expects what the second stage leaves
  Boot::jump(image());
}

}  // namespace ex9000::start_up
