#include "tests/qemu/alarm_clock.hpp"

#include <array>
#include <cstdio>
#include <cstring>
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
constexpr std::uint32_t kHalt = 20;  // not 0: behind the gate the machine halts
/// What the interrupt tells is how far behind this it loads a byte at the gate.
constexpr std::uint32_t kTold = 0x2000'8000;

constexpr std::uint32_t kReceiverEmpty = 1U << 4U;
/// The pins are told above the UART's flags.
constexpr unsigned kPins = 8;
static_assert(board::kDriverEnable.mask() != board::kStatusLed.mask());

constexpr std::uint32_t kUartFlags = 0x4000'C018;

constexpr std::uint32_t kTickCounter = 0xE000'E018;
/// From the alarm to its interrupt's end: 40 instructions.
constexpr nanoseconds kInterruptTakes{660};
constexpr nanoseconds kAtLeast{2000};

/// The interrupt.
///
/// Where a timer that goes again and again runs out while the processor sleeps, the emulator lets time pass
/// up to the next timer before the processor is woken: of the tick every second one would be lost. So between
/// two ticks there is one that wakes nobody: the guard, half a tick behind.
///
/// It makes edges by turning a pin round, for the emulated port keeps what was written to a pin as its
/// level. An edge from outside would take a stop.
constexpr std::array<std::uint16_t, 64> kHandler{
    0x4B1F,          //         ldr r3, =orders
    0x4A20,          //         ldr r2, =alarm
    0x2001,          //         movs r0, #1
    0x6250,          //         str r0, [r2, #0x24]its flag is cleared,
    0x6859,          //         ldr r1, [r3, #4]
    0xB181,          //         cbz r1, stop     no edges left
    0x3901,          //         subs r1, #1
    0x6059,          //         str r1, [r3, #4]
    0x68D9,          //         ldr r1, [r3, #12]
    0xF8D1, 0xC000,  //         ldr.w r12, [r1]
    0x6898,          //         ldr r0, [r3, #8]
    0xEA40, 0x000C,  //         orr.w r0, r0, r12
    0x6008,          //         str r0, [r1]     the pin becomes an output
    0x6918,          //         ldr r0, [r3, #16]
    0x6802,          //         ldr r2, [r0]
    0x43D2,          //         mvns r2, r2
    0x6002,          //         str r2, [r0]     of the other level
    0xF8C1, 0xC000,  //         str.w r12, [r1]  and an input again
    0x4A16,          //         ldr r2, =alarm
    0xE023,          //         b arm
    0x4917,          // stop:   ldr r1, =UART's flags
    0x6809,          //         ldr r1, [r1]
    0x4817,          //         ldr r0, =driver enable
    0x6800,          //         ldr r0, [r0]
    0xEA41, 0x2100,  //         orr.w r1, r1, r0, lsl #8
    0x4816,          //         ldr r0, =LED
    0x6800,          //         ldr r0, [r0]
    0xEA41, 0x2100,  //         orr.w r1, r1, r0, lsl #8
    0x4816,          //         ldr r0, =told
    0x5C40,          // gate:   ldrb r0, [r0, r1]it waits, and tells r1
    0x6958,          //         ldr r0, [r3, #20]
    0xB108,          //         cbz r0, on       told to go on,
    0x2003,          //         movs r0, #3
    0xBEAB,          //         bkpt 0xAB        or to halt, by "write a character"
    0x4A0E,          // on:     ldr r2, =guard
    0x2000,          //         movs r0, #0
    0x60D0,          //         str r0, [r2, #0x0C]the guard stops,
    0x2002,          //         movs r0, #2
    0x6050,          //         str r0, [r2, #0x04]goes again and again,
    0x490F,          //         ldr r1, =SysTick's counter
    0x6808,          //         ldr r0, [r1]
    0xF246, 0x11A8,  //         movw r1, #25000
    0x1A40,          //         subs r0, r0, r1
    0xDC01,          //         bgt 1f
    0xEB00, 0x0041,  //         add.w r0, r0, r1, lsl #1
    0x6290,          // 1:      str r0, [r2, #0x28]
    0x2001,          //         movs r0, #1
    0x6250,          //         str r0, [r2, #0x24]
    0x60D0,          //         str r0, [r2, #0x0C]from half a tick behind the next one or the last
    0x0049,          //         lsls r1, r1, #1
    0x6291,          //         str r1, [r2, #0x28]each tick
    0x4A03,          //         ldr r2, =alarm
    0x6818,          // arm:    ldr r0, [r3]
    0x6290,          //         str r0, [r2, #0x28]
    0x2001,          //         movs r0, #1
    0x60D0,          //         str r0, [r2, #0x0C]
    0x4770,          //         bx lr
};
constexpr std::uint32_t kGateInHandler = 0x44;
static_assert(kCode + kGateInHandler == Emulator::kGate);

/// The interrupt's code and its literals.
std::vector<std::uint8_t> code() {
  std::vector<std::uint8_t> bytes;
  for (const std::uint16_t instruction : kHandler) {
    bytes.push_back(static_cast<std::uint8_t>(instruction));
    bytes.push_back(static_cast<std::uint8_t>(instruction >> 8U));
  }
  for (const std::uint32_t literal : {kOrders, kAlarm, kGuard, kUartFlags, data_address(board::kDriverEnable),
                                      data_address(board::kStatusLed), kTickCounter, kTold}) {
    for (unsigned shift = 0; shift < 32; shift += 8) {
      bytes.push_back(static_cast<std::uint8_t>(literal >> shift));
    }
  }
  return bytes;
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
        QtestClient::write_command(kOrders + kEdges, now) +
            QtestClient::write_command(kOrders + kEdgePin, pin.mask()) +
            QtestClient::write_command(kOrders + kEdgeDirection, port_address(pin) + kDirection) +
            QtestClient::write_command(kOrders + kEdgeData, data_address(pin)));
    edges -= now;
  }
  return time;
}

void AlarmClock::run(std::uint32_t clocks, const std::string& orders) {
  begin_to_run(clocks, orders);
  if (!wait_for_alarm()) {
    throw std::runtime_error("a store that nobody waits for");
  }
}

void AlarmClock::begin_to_run(std::uint32_t clocks, const std::string& orders) {
  std::string commands = orders + QtestClient::write_command(kOrders + kNextAlarm, clocks);
  if (at_first_) {
    commands += QtestClient::write_command(kOrders + kEdges, 0) +
                QtestClient::write_command(kOrders + kHalt, 0) +
                QtestClient::write_command(kAlarm + kInterval, clocks) +
                QtestClient::write_command(kAlarm + kControl, kEnable);
  }
  at_first_ = false;
  machine_.bus().carry_out(commands);
  go_on();
}

void AlarmClock::go_on() {
  if (at_gate_) {
    at_gate_ = false;
    machine_.gate().send("g");
  } else {
    machine_.gdb().send(GdbClient::framed(go_on_));
  }
}

/// False where it has stopped in front of a store.
bool AlarmClock::wait_for_alarm() {
  while (!machine_.gdb().has_packet() && !machine_.gate().has_bytes()) {
    wait_for_any({&machine_.gdb().socket(), &machine_.gate()});
  }
  if (!machine_.gdb().has_packet()) {
    constexpr std::size_t kAddress = sizeof(std::uint32_t);
    std::array<std::uint8_t, kAddress> address{};
    machine_.gate().receive_all(address.data(), address.size());
    std::memcpy(&told_, address.data(), address.size());
    told_ -= kTold;
    at_gate_ = true;
    return true;
  }
  const std::string packet = machine_.gdb().receive();
  go_on_ = "c";
  if (packet.rfind("T05", 0) == 0 && packet.find("watch:") != std::string::npos) {
    return false;
  }
  throw Halted("the image has stopped running (" + packet + ")");
}

/// Asked by the program itself, since the emulator could not halt a processor that waits at the gate.
void AlarmClock::halt() {
  if (!at_gate_) {
    return;
  }
  machine_.bus().write(kOrders + kHalt, 1);
  go_on();
  const std::string packet = machine_.gdb().receive();
  if (packet.rfind("Fwrite,", 0) != 0) {
    throw std::runtime_error("the machine does not halt (" + packet + ")");
  }
  go_on_ = "F0";
  machine_.bus().write(kOrders + kHalt, 0);
}

void AlarmClock::watch_stores(std::uint32_t address, std::uint32_t size) {
  halt();
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
    if (gdb.receive() != "OK") {
      throw std::runtime_error("the emulator watches no stores any more");
    }
  } else {
    begin_to_run(clocks(time - kInterruptTakes), {});
  }
  at_store_ = !wait_for_alarm();
  return at_store_;
}

bool AlarmClock::receiver_empty() const { return (told_ & kReceiverEmpty) != 0; }
bool AlarmClock::driver_on() const { return (told_ >> kPins & board::kDriverEnable.mask()) != 0; }
bool AlarmClock::led_lit() const { return (told_ >> kPins & board::kStatusLed.mask()) != 0; }

}  // namespace ex9000::rig
