// The loader: copies the image of a slot to RAM and starts it. The second stage has copied it to RAM, where
// nothing else is (loader.ld). No update writes it.
//
// An image starts only if its CRC is right in RAM. One that is not confirmed starts once: its mark `tried` is
// programmed and read back before. If no image may start, the loader tries for ever, with the outputs off.
#include <array>
#include <cstdint>

#include "board.hpp"
#include "boards/rp2040/memory.hpp"
#include "firmware/bytes.hpp"
#include "firmware/update/slot.hpp"
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
using update::Slot;

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

Slot slot_in_flash(unsigned number) {
  update::SlotHead head;
  Flash::read(address_of(number), {head.data(), head.size()});
  return Slot({head.data(), head.size()});
}

/// Returns whether the image in RAM is right.
bool copy(unsigned number, const update::Info& info) {
  const std::uint32_t length = info.length();
  if (length == 0 || length > update::kLargestImage) {
    return false;
  }
  auto* const to = reinterpret_cast<std::uint8_t*>(image());
  Flash::read(address_of(number) + update::kImageAt, {to, length});
  return update::crc32({to, length}) == info.check();
}

/// Returns whether the mark `tried` is set now. An erase may be suspended since before the reset: elsewhere,
/// the flash can be programmed.
bool mark_as_tried(unsigned number) {
  constexpr std::uint32_t kMark = update::kMarksAt + update::kTried;
  std::uint8_t mark = update::kMarked;
  Flash::start_program(address_of(number) + kMark, {&mark, 1});
  while (Flash::busy()) {
  }
  Flash::read(address_of(number) + kMark, {&mark, 1});
  return mark == update::kMarked;
}

/// Returns only if the image may not start.
void start(unsigned number, const Slot& slot) {
  if (!slot.may_start() || !copy(number, slot.info) || (!slot.confirmed && !mark_as_tried(number))) {
    return;
  }
  StartedSlot::store(number);
  Clocks::use_reference();  // the image expects what the second stage leaves
  Boot::jump(image());
}

}  // namespace

/// With the PLL, because copy and CRC take the time of a start.
extern "C" __attribute__((externally_visible)) void load() {
  Watchdog::start_countdown();
  Clocks::use<board::kClock>();
  Flash::open();
  for (;;) {
    const std::array<Slot, update::kSlots> slots{slot_in_flash(0), slot_in_flash(1)};
    const unsigned first = update::first_choice(slots[0], slots[1]);
    start(first, slots[first]);
    start(1 - first, slots[1 - first]);
  }
}

}  // namespace ex9000::start_up
