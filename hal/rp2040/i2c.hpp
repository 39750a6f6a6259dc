// I2C master 0. Source: RP2040 data sheet, 4.3.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/time.hpp"
#include "hal/i2c_bus_recovery.hpp"
#include "hal/i2c_master.hpp"
#include "hal/registers/register.hpp"
#include "hal/rp2040/gpio.hpp"

namespace ex9000::hal::rp2040 {

/// The only master of a bus, at 100 kHz; functions: see I2cTransfer. `lines`: data, then clock; `clock`:
/// system clock in Hz. The main loop fills the queue of commands and empties that of received bytes. An
/// interrupt only disables itself and wakes the main loop.
template <const PinGroup& lines, std::uint32_t clock>
class I2c {
 public:
  void start() { begin_freeing(); }

  void begin(const I2cTransfer& transfer, Time now) {
    transfer_ = &transfer;
    queued_ = 0;
    received_ = 0;
    aborted_ = false;
    busy_ = true;
    if (!freeing_) {
      begin_queue(now);
    }
  }

  bool poll(Time now) {
    if (freeing_) {
      if (recovery_.poll(now)) {
        hand_over(now);
      }
      return true;
    }
    if (busy_) {
      advance(now);
    }
    return false;
  }

  [[nodiscard]] bool busy() const { return busy_; }
  [[nodiscard]] I2cResult result() const { return result_; }

  /// From the I2C interrupt, which stays asserted until the main loop has removed its cause.
  static void on_interrupt() { kInterruptMask.write({}); }

 private:
  struct Configuration;
  struct Target;
  struct DataCommand;
  struct HighCount;
  struct LowCount;
  struct Interrupts;
  struct TransmitThreshold;
  struct ClearAll;
  struct ClearAbort;
  struct Enable;
  struct Status;
  struct HoldTime;
  struct AbortSource;
  struct SpikeLength;

  static constexpr std::uint32_t kBase = 0x4004'4000U;
  static constexpr Register<Configuration> kConfiguration{kBase + 0x00};
  static constexpr Register<Target> kTarget{kBase + 0x04};
  static constexpr Register<DataCommand> kDataCommand{kBase + 0x10};
  static constexpr Register<HighCount> kHighCount{kBase + 0x14};
  static constexpr Register<LowCount> kLowCount{kBase + 0x18};
  static constexpr Register<Interrupts> kInterruptMask{kBase + 0x30};
  static constexpr Register<Interrupts> kRawInterrupts{kBase + 0x34};
  static constexpr Register<TransmitThreshold> kTransmitThreshold{kBase + 0x3C};
  static constexpr Register<ClearAll> kClearAll{kBase + 0x40};
  static constexpr Register<ClearAbort> kClearAbort{kBase + 0x54};
  static constexpr Register<Enable> kEnable{kBase + 0x6C};
  static constexpr Register<Status> kStatus{kBase + 0x70};
  static constexpr Register<HoldTime> kHoldTime{kBase + 0x7C};
  static constexpr Register<AbortSource> kAbortSource{kBase + 0x80};
  static constexpr Register<SpikeLength> kSpikeLength{kBase + 0xA0};

  static constexpr Bits<DataCommand> kRead{1U << 8U};
  static constexpr Bits<DataCommand> kThenStop{1U << 9U};
  static constexpr Bits<Interrupts> kQueueLow{1U << 4U};
  static constexpr Bits<Interrupts> kAborted{1U << 6U};
  static constexpr Bits<Interrupts> kStopped{1U << 9U};
  static constexpr Bits<Status> kRoom{1U << 1U};
  static constexpr Bits<Status> kReceived{1U << 3U};
  static constexpr Bits<Enable> kOn{1U << 0U};
  static constexpr Bits<AbortSource> kNoAcknowledge{1U << 0U | 1U << 3U};  // of the address; of a data byte

  /// Entries of each queue.
  static constexpr std::size_t kQueue = 16;
  /// From the last command queued or byte taken. A full queue takes 1.5 ms; the main loop may add delays.
  static constexpr Duration kTimeout = milliseconds(5);

  // --- freeing the bus ---

  struct Wires {
    static constexpr std::uint32_t kData = 1U << lines.first_pin;
    static constexpr std::uint32_t kClock = 2U << lines.first_pin;
    static void take() {
      Gpio::write(kData | kClock, 0);
      Gpio::make_input(kData | kClock, true);
    }
    static void pull(bool clock_line, bool data_line) {
      Gpio::choose_outputs(kData | kClock, (clock_line ? kClock : 0) | (data_line ? kData : 0));
    }
    static bool data_is_high() { return Gpio::read(kData) != 0; }
  };

  void begin_freeing() {
    kInterruptMask.write({});
    kEnable.write({});
    recovery_.begin();
    freeing_ = true;
  }

  /// Sets up the master and connects the pins. Begins a transfer that waits.
  void hand_over(Time now) {
    constexpr std::uint32_t kBitRate = 100'000;
    constexpr std::uint32_t kPeriod = clock / kBitRate;
    constexpr std::uint32_t kLow = kPeriod * 3U / 5U;            // 6 us; the minimum is 4.7 us
    constexpr std::uint32_t kSpike = clock / 20'000'000 + 1U;    // at least 50 ns
    constexpr std::uint32_t kHold = clock / 3'333'333 + 1U;      // at least 300 ns
    constexpr Bits<Configuration> kMaster(1U << 0U | 1U << 6U);  // and not a slave
    constexpr Bits<Configuration> kStandardMode(1U << 1U);
    constexpr Bits<Configuration> kRestart(1U << 5U);
    constexpr Bits<Configuration> kQueueLowAfterByte(1U << 8U);
    kConfiguration.write(kMaster | kStandardMode | kRestart | kQueueLowAfterByte);
    kHighCount.write(Bits<HighCount>(kPeriod - kLow));
    kLowCount.write(Bits<LowCount>(kLow));
    kSpikeLength.write(Bits<SpikeLength>(kSpike));
    kHoldTime.write(Bits<HoldTime>(kHold));
    kTransmitThreshold.write(Bits<TransmitThreshold>(kQueue / 4U));
    Gpio::make_peripheral(lines.mask(), Function::I2c);
    freeing_ = false;
    if (busy_) {
      begin_queue(now);
    }
  }

  // --- a transfer ---

  void begin_queue(Time now) {
    // The target can be changed only while the master is off, which also empties the queues.
    kEnable.write({});
    kTarget.write(Bits<Target>(transfer_->device));
    kEnable.write(kOn);
    (void)kClearAll.read();    // a read clears all flags that software can clear
    (void)kClearAbort.read();  // after an abort, the queue discards commands until this read
    deadline_.set(now + kTimeout);
    fill(now);
  }

  void advance(Time now) {
    const Bits<Interrupts> events = kRawInterrupts.read();
    if (events.has(kAborted) && !aborted_) {
      aborted_ = true;
      result_ = kAbortSource.read().has(kNoAcknowledge) ? I2cResult::NoAcknowledge : I2cResult::Failed;
    }
    take_received(now);
    if (events.has(kStopped)) {
      finish(aborted_ ? result_ : I2cResult::Done);
    } else if (deadline_.reached(now)) {
      finish(I2cResult::Failed);
      begin_freeing();
    } else {
      fill(now);
    }
  }

  void take_received(Time now) {
    while (received_ < transfer_->destination.size && kStatus.read().has(kReceived)) {
      transfer_->destination.data[received_] = static_cast<std::uint8_t>(kDataCommand.read().value());
      ++received_;
      deadline_.set(now + kTimeout);
    }
  }

  /// Commands while the queues have room, none after an abort. Enables the interrupts for the next event.
  void fill(Time now) {
    const std::size_t size = transfer_->size();
    while (!aborted_ && queued_ < size && has_room()) {
      const Bits<DataCommand> last = queued_ + 1U == size ? kThenStop : Bits<DataCommand>();
      kDataCommand.write((transfer_->writes() ? Bits<DataCommand>(transfer_->byte(queued_)) : kRead) | last);
      ++queued_;
      deadline_.set(now + kTimeout);
    }
    const bool more = !aborted_ && queued_ < size;
    kInterruptMask.write(kStopped | kAborted | (more ? kQueueLow : Bits<Interrupts>()));
  }

  /// For a command and, in a read, also for the byte that it reads.
  [[nodiscard]] bool has_room() const {
    return kStatus.read().has(kRoom) && (transfer_->writes() || queued_ - received_ < kQueue);
  }

  void finish(I2cResult result) {
    kInterruptMask.write({});
    result_ = result;
    busy_ = false;
  }

  bool freeing_ = true;
  bool busy_ = false;
  bool aborted_ = false;
  I2cResult result_ = {};
  std::size_t queued_ = 0;    ///< number of commands that have been queued
  std::size_t received_ = 0;  ///< number of bytes that have been received
  Deadline deadline_;
  I2cBusRecovery<Wires> recovery_;
  const I2cTransfer* transfer_ = nullptr;
};

}  // namespace ex9000::hal::rp2040
