#include "tests/qemu/alarm_clock.hpp"

#include <array>
#include <cstdio>
#include <stdexcept>
#include <vector>

namespace ex9000::rig {

namespace {

using std::chrono::nanoseconds;

// GPTM3 is the timer of the alarm. Images use the other timers.
constexpr std::uint32_t kTimers = 0x4003'0000;
constexpr std::uint32_t kTimerSize = 0x1000;
constexpr std::uint32_t kTimerCount = 4;
constexpr std::uint32_t kAlarm = kTimers + 3 * kTimerSize;
constexpr std::uint32_t kMode = 0x04;
constexpr std::uint32_t kOneShot = 1;
constexpr std::uint32_t kControl = 0x0C;
constexpr std::uint32_t kEnable = 1;
constexpr std::uint32_t kInterruptMask = 0x18;
constexpr std::uint32_t kInterruptClear = 0x24;
constexpr std::uint32_t kInterval = 0x28;
constexpr std::uint32_t kTimeout = 1;

constexpr std::uint32_t kAlarmInterrupt = 35;
constexpr std::uint32_t kSetEnable = 0xE000'E104;  // for interrupts from 32 on
constexpr std::uint32_t kVectorTableOffset = 0xE000'ED08;
constexpr std::uint32_t kExceptions = 16;
/// The number of vectors in an image: 16 exceptions and the interrupts 0 to 31.
constexpr std::uint32_t kVectors = kExceptions + 32;

// Addresses in RAM between the data of an image at the bottom and the stack at the top. The emulator
// retranslates code if data near it is written, so the data that the test bench writes is far from code.
constexpr std::uint32_t kTable = 0x2000'8000;
constexpr std::uint32_t kCode = 0x2000'9000;
constexpr std::uint32_t kOrders = 0x2000'A000;
constexpr std::uint32_t kThumb = 1;

/// Offsets of the interrupt code's parameters from kOrders. Each parameter is one word.
constexpr std::uint32_t kNextAlarm = 0;  // clocks
constexpr std::uint32_t kEdges = 4;      // number of alarms that make an edge instead of stopping the machine
constexpr std::uint32_t kEdgePin = 8;    // mask
constexpr std::uint32_t kEdgeDirection = 12;
constexpr std::uint32_t kEdgeData = 16;
constexpr std::uint32_t kHalt = 20;  // if not 0, the machine halts after the gate
constexpr std::uint32_t kLeft = 24;  // remaining clocks after the current part of the time
/// The interrupt code reports the UART flags and two pin levels as the distance from this address to the
/// address of the byte that it loads at the gate.
constexpr std::uint32_t kReportBase = 0x2000'8000;

constexpr std::uint32_t kReceiverEmpty = 1U << 4U;
/// A report contains the pin levels from this bit on. The UART flags are in the bits below it.
constexpr unsigned kPins = 8;
static_assert(board::kDriverEnable.mask() != board::kStatusLed.mask());

constexpr std::uint32_t kUartFlags = 0x4000'C018;

constexpr std::uint32_t kTickCounter = 0xE000'E018;
/// The time from the alarm to the end of its interrupt: 29 instructions of 16 ns, and 16 ns more.
constexpr nanoseconds kInterruptTakes{480};
constexpr nanoseconds kAtLeast{2000};

constexpr std::array<std::uint16_t, 64> kHandler{
#include "tests/qemu/alarm_interrupt.inc"
};
constexpr std::uint32_t kGateInHandler = 0x48;
static_assert(kCode + kGateInHandler == Emulator::kGate);

/// Returns the interrupt code and its literals.
std::vector<std::uint8_t> code() {
  std::vector<std::uint8_t> bytes;
  for (const std::uint16_t instruction : kHandler) {
    bytes.push_back(static_cast<std::uint8_t>(instruction));
    bytes.push_back(static_cast<std::uint8_t>(instruction >> 8U));
  }
  for (const std::uint32_t literal : {kOrders, kAlarm, kUartFlags, data_address(board::kDriverEnable),
                                      data_address(board::kStatusLed), kReportBase}) {
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
    // A reset does not affect the emulated timers.
    write(timer + kControl, 0);
    write(timer + kInterruptMask, 0);
    write(timer + kInterruptClear, kTimeout);
  }
  write(kAlarm + kMode, kOneShot);
  write(kAlarm + kInterruptMask, kTimeout);
  write(kSetEnable, 1U << (kAlarmInterrupt - 32));
  bus.carry_out(commands);
  at_first_ = true;
}

std::uint32_t AlarmClock::clocks(nanoseconds time) {
  // The emulated processor's clock is 200 MHz divided by 16 after a reset, and later 200 MHz divided by the
  // divider that the image sets.
  constexpr std::uint32_t kDivider = 16;
  constexpr std::int64_t kPllClock = 5;
  const std::int64_t period = kPllClock * (at_first_ ? kDivider : board::kClock.divider);
  return static_cast<std::uint32_t>(time.count() / period);
}

void AlarmClock::run_for(nanoseconds time) {
  // The time until the first alarm is not divided into parts (see alarm_interrupt.inc), so the first alarm
  // must occur before the first tick.
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
  constexpr std::uint32_t kAtOnce = 200'000;  // less than 1 s, so that the watchdog does not expire
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
  std::string commands = orders;
  if (at_first_ || ordered_ != clocks) {  // `clocks` is often the same for several bytes of a request
    commands += QtestClient::write_command(kOrders + kNextAlarm, clocks);
    ordered_ = clocks;
  }
  if (at_first_) {
    commands += QtestClient::write_command(kOrders + kEdges, 0) +
                QtestClient::write_command(kOrders + kHalt, 0) +
                QtestClient::write_command(kOrders + kLeft, 0) +
                QtestClient::write_command(kAlarm + kInterval, clocks) +
                QtestClient::write_command(kAlarm + kControl, kEnable);
  }
  at_first_ = false;
  if (!commands.empty()) {
    machine_.bus().carry_out(commands);
  }
  go_on();
  wait_for_alarm();
}

void AlarmClock::go_on() {
  if (at_gate_) {
    at_gate_ = false;
    machine_.gate().send("g");
  } else {
    machine_.gdb().send(GdbClient::framed(go_on_));
  }
}

/// Waits until the processor waits at the gate.
void AlarmClock::wait_for_alarm() {
  // The emulator can take seconds for an interrupt storm of 1.6 s of emulated time, and more than `kHang` on
  // a busy host. The emulator still replies to reads during that time.
  constexpr int kMostQuestions = 5;
  for (int asked = 0; !machine_.gdb().has_packet() && !machine_.gate().has_bytes();) {
    if (!wait_for_any({&machine_.gdb().socket(), &machine_.gate()})) {
      if (++asked > kMostQuestions) {
        throw std::runtime_error(
            "emulator: it does not stop for 6 minutes; expected it to stop at the alarm");
      }
      machine_.bus().read(kTickCounter);
    }
  }
  if (!machine_.gdb().has_packet()) {
    std::array<std::uint64_t, 2> said{};  // see gate.cpp
    machine_.gate().receive_all(reinterpret_cast<std::uint8_t*>(said.data()), sizeof said);
    last_report_ = static_cast<std::uint32_t>(said[0]) - kReportBase;
    instructions_ = said[1];
    at_gate_ = true;
    return;
  }
  const std::string packet = machine_.gdb().receive();
  go_on_ = "c";
  throw Halted("image: it has stopped with " + packet + "; expected it to run until the alarm");
}

/// Makes the interrupt code request the halt, because the emulator cannot halt a processor that waits at the
/// gate.
void AlarmClock::halt() {
  if (!at_gate_) {
    return;
  }
  machine_.bus().write(kOrders + kHalt, 1);
  go_on();
  const std::string packet = machine_.gdb().receive();
  if (packet.rfind("Fwrite,", 0) != 0) {
    throw std::runtime_error("emulator: it replies " + packet + " to a halt; expected Fwrite");
  }
  go_on_ = "F0";
  machine_.bus().write(kOrders + kHalt, 0);
}

bool AlarmClock::receiver_empty() const { return (last_report_ & kReceiverEmpty) != 0; }
bool AlarmClock::driver_on() const { return (last_report_ >> kPins & board::kDriverEnable.mask()) != 0; }
bool AlarmClock::led_lit() const { return (last_report_ >> kPins & board::kStatusLed.mask()) != 0; }

}  // namespace ex9000::rig
