// I2C master 0. Sources: LM3S6965 data sheet, 14.3 to 14.5; TM4C123GH6PM data sheet, 16.3 to 16.5.
#pragma once

#include <cstddef>
#include <cstdint>

#include "firmware/crossing.hpp"
#include "firmware/time.hpp"
#include "hal/i2c_bus_recovery.hpp"
#include "hal/i2c_master.hpp"
#include "hal/registers/register.hpp"
#include "hal/stellaris/gpio.hpp"

namespace ex9000::hal::stellaris {

/// The only master of its bus, at 100 kHz at most; functions: see I2cTransfer. The interrupt counts each byte
/// and wakes the main loop, which continues the transfer.
template <Family family, std::uint32_t clock>
class I2c {
 public:
  void start() { begin_freeing(); }

  void begin(const I2cTransfer& transfer, Time now) {
    transfer_ = &transfer;
    done_ = 0;
    busy_ = true;
    if (step_ == Step::Idle) {
      address(now);
    }
  }

  bool poll(Time now) {
    switch (step_) {
      case Step::Idle:
        return false;
      case Step::Freeing:
        if (recovery_.poll(now)) {
          hand_over(now);
        }
        return true;
      case Step::Moving:
        break;
    }
    const bool byte_completed = completed_.load() != completed_seen_;
    const Bits<ControlStatus> status = kControlStatus.read();
    // Busy after the interrupt: that was for an aborted transfer.
    if (byte_completed && !status.has(kBusy)) {
      next(status, now);
    } else if (deadline_.reached(now)) {
      give_up(I2cResult::Failed);
    }
    return false;
  }

  [[nodiscard]] bool busy() const { return busy_; }
  [[nodiscard]] I2cResult result() const { return result_; }

  /// From the I2C interrupt: a byte has ended, with or without an error.
  void on_interrupt() {
    kInterruptClear.write(Bits<InterruptClear>(1));
    completed_.store_in_interrupt(completed_.load() + 1U);
  }

 private:
  struct TargetAddress;
  struct ControlStatus;
  struct Data;
  struct TimerPeriod;
  struct InterruptMask;
  struct InterruptClear;
  struct Configuration;
  struct SoftwareReset;

  enum class Step : std::uint8_t {
    Freeing,  ///< the driver controls the pins directly
    Idle,
    Moving,  ///< a byte is being transferred
  };

  static constexpr std::uint32_t kBase = 0x4002'0000U;
  static constexpr Register<TargetAddress> kTargetAddress{kBase + 0x000};
  static constexpr Register<ControlStatus> kControlStatus{kBase + 0x004};
  static constexpr Register<Data> kData{kBase + 0x008};
  static constexpr Register<TimerPeriod> kTimerPeriod{kBase + 0x00C};
  static constexpr Register<InterruptMask> kInterruptMask{kBase + 0x010};
  static constexpr Register<InterruptClear> kInterruptClear{kBase + 0x01C};
  static constexpr Register<Configuration> kConfiguration{kBase + 0x020};
  static constexpr Register<SoftwareReset> kSoftwareReset{0x400F'E044};  // in system control

  // Bits for writing
  static constexpr Bits<ControlStatus> kRun{1U << 0U};
  static constexpr Bits<ControlStatus> kStart{1U << 1U};
  static constexpr Bits<ControlStatus> kStop{1U << 2U};
  static constexpr Bits<ControlStatus> kAcknowledge{1U << 3U};
  // Bits for reading
  static constexpr Bits<ControlStatus> kBusy{1U << 0U};  // while it is set, the other bits are invalid
  static constexpr Bits<ControlStatus> kError{1U << 1U};
  static constexpr Bits<ControlStatus> kArbitrationLost{1U << 4U};

  // The pins are the same on both families.
  static constexpr Gpio kPort{Port::B};
  static constexpr std::uint32_t kClock = 1U << 2U;
  static constexpr std::uint32_t kDataPin = 1U << 3U;
  static constexpr std::uint32_t kBoth = kClock | kDataPin;
  static constexpr std::uint32_t kPortControlFunction = 3;

  /// A byte takes about 90 us, the address before the first as long. The rest is a reserve.
  static constexpr Duration kByteTimeout = milliseconds(3);

  // --- freeing the bus ---

  struct Wires {
    static void take() {
      kPort.take_from_peripheral(kBoth);
      kPort.make_input(kBoth, true);  // with the weak pull-ups, the lines are high on a board without EEPROM
    }
    static void pull(bool clock_line, bool data_line) {
      kPort.choose_outputs(kBoth, (clock_line ? kClock : 0) | (data_line ? kDataPin : 0));
      kPort.write(kBoth, 0);
    }
    static bool data_is_high() { return kPort.read(kDataPin) != 0; }
  };

  /// Resets the peripheral, which would else report the end of an unfinished byte as that of the next.
  void begin_freeing() {
    constexpr Bits<SoftwareReset> kI2c0(1U << 12U);
    kSoftwareReset.write(kI2c0);
    kSoftwareReset.write({});
    recovery_.begin();
    step_ = Step::Freeing;
  }

  /// Connects the pins and starts the peripheral. Begins a transfer that waits.
  void hand_over(Time now) {
    constexpr std::uint32_t kBitRate = 100'000;
    constexpr std::uint32_t kClocksAStep = 2U * (6U + 4U);  // low and high time of SCL
    constexpr Bits<Configuration> kMaster(1U << 4U);
    kPort.make_peripheral<family, kBoth, kPortControlFunction>();
    if constexpr (family == Family::Lm3s) {
      kPort.set_open_drain(kBoth);
    } else {
      kPort.set_open_drain(kDataPin);  // the clock pin must not be open-drain
    }
    kConfiguration.write(kMaster);
    kTimerPeriod.write(
        Bits<TimerPeriod>((clock + kClocksAStep * kBitRate - 1U) / (kClocksAStep * kBitRate) - 1U));
    kControlStatus.write(kStop);  // after a reset, the master may still consider the bus busy
    kInterruptMask.write(Bits<InterruptMask>(1));
    step_ = Step::Idle;
    if (busy_) {
      address(now);
    }
  }

  // --- a transfer ---

  void address(Time now) {
    constexpr std::uint32_t kReading = 1;
    kTargetAddress.write(
        Bits<TargetAddress>((std::uint32_t{transfer_->device} << 1U) | (transfer_->writes() ? 0 : kReading)));
    move(kStart, now);
  }

  void move(Bits<ControlStatus> start, Time now) {
    const bool last = done_ + 1U == transfer_->size();
    if (transfer_->writes()) {
      kData.write(Bits<Data>(transfer_->byte(done_)));
    }
    step_ = Step::Moving;
    deadline_.set(now + kByteTimeout);
    completed_seen_ = completed_.load();  // ignores the interrupt of an aborted transfer
    kControlStatus.write(kRun | start |
                         (last                  ? kStop
                          : transfer_->writes() ? Bits<ControlStatus>()
                                                : kAcknowledge));
  }

  void next(Bits<ControlStatus> status, Time now) {
    // Both bits: the TM4C123 data sheet does not say that lost arbitration sets the error bit.
    if (status.has(kError | kArbitrationLost)) {
      // There is no other master: lost arbitration means that a line is stuck.
      give_up(status.has(kArbitrationLost) ? I2cResult::Failed : I2cResult::NoAcknowledge);
      return;
    }
    if (!transfer_->writes()) {
      transfer_->destination.data[done_] = static_cast<std::uint8_t>(kData.read().value());
    }
    if (++done_ == transfer_->size()) {
      finish(I2cResult::Done);
    } else {
      move({}, now);
    }
  }

  /// Aborts the transfer. The recovery of the bus also ends it in the device.
  void give_up(I2cResult result) {
    finish(result);
    begin_freeing();
  }

  void finish(I2cResult result) {
    result_ = result;
    step_ = Step::Idle;
    busy_ = false;
  }

  Step step_ = Step::Freeing;
  I2cResult result_ = {};
  bool busy_ = false;
  std::uint8_t done_ = 0;  ///< number of transferred bytes
  std::uint32_t completed_seen_ = 0;
  WrittenByInterrupt<std::uint32_t> completed_;
  Deadline deadline_;
  I2cBusRecovery<Wires> recovery_;
  const I2cTransfer* transfer_ = nullptr;
};

}  // namespace ex9000::hal::stellaris
