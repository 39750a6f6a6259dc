#include "tests/qemu/alarm_clock.hpp"

#include <array>
#include <cstdio>
#include <stdexcept>
#include <vector>

namespace ex9000::rig {

namespace {

using std::chrono::nanoseconds;

// GPTM2 is the alarm, GPTM3 the guard; the image uses the others.
constexpr std::uint32_t kTimers = 0x4003'0000;
constexpr std::uint32_t kTimerSize = 0x1000;
constexpr std::uint32_t kTimerCount = 4;
constexpr std::uint32_t kAlarm = kTimers + 2 * kTimerSize;
constexpr std::uint32_t kGuard = kTimers + 3 * kTimerSize;
constexpr std::uint32_t kMode = 0x04;
constexpr std::uint32_t kOneShot = 1;
constexpr std::uint32_t kControl = 0x0C;
constexpr std::uint32_t kEnable = 1;
constexpr std::uint32_t kInterruptMask = 0x18;
constexpr std::uint32_t kInterruptClear = 0x24;
constexpr std::uint32_t kInterval = 0x28;
constexpr std::uint32_t kTimeout = 1;

constexpr std::uint32_t kAlarmInterrupt = 23;
constexpr std::uint32_t kSetEnable = 0xE000'E100;
constexpr std::uint32_t kVectorTableOffset = 0xE000'ED08;
constexpr std::uint32_t kExceptions = 16;
/// As many vectors as an image has: 22 interrupts.
constexpr std::uint32_t kVectors = kExceptions + 22;

// RAM between what an image keeps at its bottom and the stack at its top. The emulator translates anew what
// is written near, so what the rig writes is kept away from code.
constexpr std::uint32_t kTable = 0x2000'8000;
constexpr std::uint32_t kCode = 0x2000'9000;
constexpr std::uint32_t kOrders = 0x2000'A000;
constexpr std::uint32_t kThumb = 1;

/// The orders to the interrupt's code, a word each.
constexpr std::uint32_t kNextAlarm = 0;  // clocks
constexpr std::uint32_t kEdges = 4;      // so many alarms make an edge each and do not stop the machine
constexpr std::uint32_t kEdgePin = 8;    // mask
constexpr std::uint32_t kEdgeDirection = 12;
constexpr std::uint32_t kEdgeData = 16;

constexpr std::uint32_t kReceiverEmpty = 1U << 4U;
/// The pins are told above the UART's flags.
constexpr unsigned kPins = 8;
static_assert(board::kDriverEnable.mask() != board::kStatusLed.mask());
constexpr std::uint32_t kNotYet = 1U << 31U;

constexpr std::uint32_t kUartFlags = 0x4000'C018;

constexpr std::uint32_t kTickCounter = 0xE000'E018;
/// From the alarm to its interrupt's end: the guard's time, and 40 instructions before and behind.
constexpr nanoseconds kInterruptTakes{10'660};
constexpr nanoseconds kAtLeast{2000};

/// The interrupt.
///
/// Where an emulated processor asks to be stopped, the emulator may find it idle first, and then it lets time
/// pass up to the next timer that runs out; whether it does is the host's doing. So there is one that runs
/// out soon, the guard, and the processor asks again until it has: then it is this time and no other,
/// whichever way it came.
///
/// And where a timer that goes again and again runs out while the processor sleeps, the emulator lets time
/// pass up to the next timer before the processor is woken: of the tick every second one would be lost. So
/// between two ticks there is one that wakes nobody: the guard, while the machine runs, half a tick behind.
///
/// It makes edges by turning a pin round, for the emulated port keeps what was written to a pin as its
/// level. An edge from outside would take a stop.
constexpr std::array<std::uint16_t, 72> kHandler{
    0x4B23,          //         ldr r3, =orders
    0x4A24,          //         ldr r2, =alarm
    0x2001,          //         movs r0, #1
    0x6250,          //         str r0, [r2, #0x24]     its flag is cleared
    0x6859,          //         ldr r1, [r3, #4]
    0xB181,          //         cbz r1, stop            no edges left
    0x3901,          //         subs r1, #1
    0x6059,          //         str r1, [r3, #4]
    0x68D9,          //         ldr r1, [r3, #12]
    0xF8D1, 0xC000,  //         ldr r12, [r1]
    0x6898,          //         ldr r0, [r3, #8]
    0xEA40, 0x000C,  //         orr r0, r0, r12
    0x6008,          //         str r0, [r1]            the pin becomes an output
    0x6918,          //         ldr r0, [r3, #16]
    0x6802,          //         ldr r2, [r0]
    0x43D2,          //         mvns r2, r2
    0x6002,          //         str r2, [r0]            of the other level
    0xF8C1, 0xC000,  //         str r12, [r1]           and an input again
    0x4A1A,          //         ldr r2, =alarm
    0xE02B,          //         b arm
    0x4A1A,          // stop:   ldr r2, =guard
    0x2000,          //         movs r0, #0
    0x60D0,          //         str r0, [r2, #0x0C]     it stops being half a tick behind,
    0x2001,          //         movs r0, #1
    0x6050,          //         str r0, [r2, #0x04]
    0x6250,          //         str r0, [r2, #0x24]
    0x21FA,          //         movs r1, #250
    0x0049,          //         lsls r1, r1, #1
    0x6291,          //         str r1, [r2, #0x28]
    0x60D0,          //         str r0, [r2, #0x0C]     and runs out once, in 10 us
    0x4916,          //         ldr r1, =UART's flags
    0x6809,          //         ldr r1, [r1]
    0x4816,          //         ldr r0, =driver enable
    0x6800,          //         ldr r0, [r0]
    0xEA41, 0x2100,  //         orr r1, r1, r0, lsl #8
    0x4815,          //         ldr r0, =LED
    0x6800,          //         ldr r0, [r0]
    0xEA41, 0x2100,  //         orr r1, r1, r0, lsl #8
    0x2003,          // again:  movs r0, #3             "write a character",
    0xBEAB,          //         bkpt 0xAB               for which a debugger is stopped and told r1
    0xF04F, 0x4100,  //         mov r1, #0x80000000     not yet, if it is asked for once more
    0x69D0,          //         ldr r0, [r2, #0x1C]
    0x2800,          //         cmp r0, #0
    0xD0F8,          //         beq again               until the guard has run out
    0x2002,          //         movs r0, #2
    0x6050,          //         str r0, [r2, #0x04]     it goes again and again
    0x490F,          //         ldr r1, =SysTick's counter
    0x6808,          //         ldr r0, [r1]
    0x6158,          //         str r0, [r3, #20]
    0xF246, 0x11A8,  //         movw r1, #25000
    0x1A40,          //         subs r0, r0, r1
    0xDC01,          //         bgt 1f
    0xEB00, 0x0041,  //         add r0, r0, r1, lsl #1
    0x6290,          // 1:      str r0, [r2, #0x28]
    0x2001,          //         movs r0, #1
    0x60D0,          //         str r0, [r2, #0x0C]     from half a tick behind the next one or the last
    0x0049,          //         lsls r1, r1, #1
    0x6291,          //         str r1, [r2, #0x28]     each tick
    0x4A03,          //         ldr r2, =alarm
    0x6818,          // arm:    ldr r0, [r3]
    0x6290,          //         str r0, [r2, #0x28]
    0x2001,          //         movs r0, #1
    0x60D0,          //         str r0, [r2, #0x0C]
    0x4770,          //         bx lr
};

/// The interrupt's code and its literals.
std::vector<std::uint8_t> code() {
  std::vector<std::uint8_t> bytes;
  for (const std::uint16_t instruction : kHandler) {
    bytes.push_back(static_cast<std::uint8_t>(instruction));
    bytes.push_back(static_cast<std::uint8_t>(instruction >> 8U));
  }
  for (const std::uint32_t literal : {kOrders, kAlarm, kGuard, kUartFlags, data_address(board::kDriverEnable),
                                      data_address(board::kStatusLed), kTickCounter}) {
    for (unsigned shift = 0; shift < 32; shift += 8) {
      bytes.push_back(static_cast<std::uint8_t>(literal >> shift));
    }
  }
  return bytes;
}

/// GDB's packet that writes these words to RAM.
std::string write_words(std::uint32_t address, const std::vector<std::uint32_t>& words) {
  static constexpr std::array<char, 17> kDigits{"0123456789abcdef"};
  std::string packet = "M";
  const auto digits = [&packet](std::uint32_t value, unsigned count) {
    for (unsigned i = count; i-- != 0;) {
      packet += kDigits[value >> (4 * i) & 0xFU];
    }
  };
  digits(address, 8);
  packet += ',';
  digits(static_cast<std::uint32_t>(words.size() * 4), 8);
  packet += ':';
  for (const std::uint32_t word : words) {
    for (unsigned byte = 0; byte < 4; ++byte) {
      digits(word >> (8 * byte) & 0xFFU, 2);
    }
  }
  return GdbClient::framed(packet);
}

}  // namespace

void AlarmClock::set_up() {
  std::string commands;
  const auto write = [&commands](std::uint32_t address, std::uint32_t value) {
    commands += QtestClient::write_command(address, value);
  };
  QtestClient& bus = machine_.bus();
  const std::vector<std::uint8_t> vectors = bus.read(0, kVectors * 4);
  bus.write(kTable, vectors);
  write(kTable + (kExceptions + kAlarmInterrupt) * 4, kCode | kThumb);
  bus.write(kCode, code());
  write(kVectorTableOffset, kTable);
  for (std::uint32_t timer = kTimers; timer < kTimers + kTimerCount * kTimerSize; timer += kTimerSize) {
    // The emulated timers know no reset.
    write(timer + kControl, 0);
    write(timer + kInterruptMask, 0);
    write(timer + kInterruptClear, kTimeout);
  }
  write(kAlarm + kMode, kOneShot);
  write(kAlarm + kInterruptMask, kTimeout);
  write(kSetEnable, 1U << kAlarmInterrupt);
  bus.carry_out(commands);
  at_first_ = true;
}

std::uint32_t AlarmClock::clocks(nanoseconds time) {
  // The processor runs on the PLL's 200 MHz, divided by what the image sets, and by 16 before.
  constexpr std::uint32_t kDivider = 16;
  constexpr std::int64_t kPllClock = 5;
  const std::int64_t period = kPllClock * (at_first_ ? kDivider : board::kClock.divider);
  return static_cast<std::uint32_t>(time.count() / period);
}

void AlarmClock::run_for(nanoseconds time) {
  // The tick is not doubled before it has been seen; there has been none so early.
  constexpr std::chrono::milliseconds kBeforeTicks{1};
  if (at_first_ && time > 2 * kBeforeTicks) {
    run_for(kBeforeTicks);
    time -= kBeforeTicks;
  }
  const nanoseconds left = time - kInterruptTakes;
  run(clocks(left < kAtLeast ? kAtLeast : left));
}

nanoseconds AlarmClock::make_edges(Pin pin, std::uint32_t edges) {
  constexpr nanoseconds kEach{4'000};
  constexpr std::uint32_t kDirection = 0x400;
  constexpr std::uint32_t kAtOnce = 200'000;  // a second, which no watchdog minds
  const nanoseconds time = kEach * (std::int64_t{edges} + 1);
  while (edges != 0) {
    const std::uint32_t now = edges < kAtOnce ? edges : kAtOnce;
    run(clocks(kEach),
        write_words(kOrders + kEdges, {now, pin.mask(), port_address(pin) + kDirection, data_address(pin)}));
    edges -= now;
  }
  return time;
}

void AlarmClock::run(std::uint32_t clocks, const std::string& more) {
  begin_to_run(clocks, more);
  if (!wait_for_alarm()) {
    throw std::runtime_error("a store that nobody waits for");
  }
}

void AlarmClock::begin_to_run(std::uint32_t clocks, const std::string& more) {
  std::string packets = more + write_words(kOrders + kNextAlarm, {clocks});
  if (at_first_) {
    packets += write_words(kOrders + kEdges, {0});
    machine_.bus().carry_out(QtestClient::write_command(kAlarm + kInterval, clocks) +
                             QtestClient::write_command(kAlarm + kControl, kEnable));
  }
  at_first_ = false;
  machine_.gdb().send(packets + GdbClient::framed(go_on_));
}

/// False where it has stopped in front of a store.
bool AlarmClock::wait_for_alarm() {
  for (;;) {
    const std::string packet = machine_.gdb().receive();
    if (packet == "OK") {
      continue;
    }
    if (packet.rfind("T05", 0) == 0 && packet.find("watch:") != std::string::npos) {
      go_on_ = "c";
      return false;
    }
    // Fwrite,2,ADDRESS,1
    const std::size_t address = packet.find(',', packet.find(',') + 1) + 1;
    if (packet.rfind("Fwrite,", 0) != 0 || address == 0) {
      go_on_ = "c";
      throw Halted("the image has stopped running (" + packet + ")");
    }
    go_on_ = "F0";
    constexpr int kHex = 16;
    const auto told = static_cast<std::uint32_t>(std::stoull(packet.substr(address), nullptr, kHex));
    if (told != kNotYet) {
      seen_ = told;
      return true;
    }
    machine_.gdb().send(GdbClient::framed(go_on_));
  }
}

void AlarmClock::watch_stores(std::uint32_t address, std::uint32_t size) {
  std::array<char, 32> range{};
  (void)std::snprintf(range.data(), range.size(), "2,%x,%x", address, size);
  watched_ = range.data();
  machine_.gdb().send(GdbClient::framed("Z" + watched_));
  if (machine_.gdb().receive() != "OK") {
    throw std::runtime_error("the emulator watches no stores");
  }
}

/// Where the emulator counts instructions it stops in front of what is watched, and again each time that it
/// is to go on: so that one instruction is carried out while nothing is watched.
bool AlarmClock::run_to_store(nanoseconds time) {
  if (at_store_) {
    GdbClient& gdb = machine_.gdb();
    gdb.send(GdbClient::framed("z" + watched_) + GdbClient::framed("s"));
    while (gdb.receive() == "OK") {
    }
    gdb.send(GdbClient::framed("Z" + watched_) + GdbClient::framed("c"));
  } else {
    begin_to_run(clocks(time - kInterruptTakes), {});
  }
  at_store_ = !wait_for_alarm();
  return at_store_;
}

bool AlarmClock::receiver_empty() const { return (seen_ & kReceiverEmpty) != 0; }
bool AlarmClock::driver_on() const { return (seen_ >> kPins & board::kDriverEnable.mask()) != 0; }
bool AlarmClock::led_lit() const { return (seen_ >> kPins & board::kStatusLed.mask()) != 0; }

}  // namespace ex9000::rig
