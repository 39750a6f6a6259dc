// A PL011 UART and its RS-485 driver. Sources: LM3S6965 data sheet, 12.3 to 12.5; TM4C123GH6PM data sheet,
// 14.3 to 14.5; RP2040 data sheet, 4.2; Arm PrimeCell UART (PL011) TRM, 2.4 and 3.3.
#pragma once

#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/crossing.hpp"
#include "firmware/line/timing.hpp"
#include "firmware/line/verdict.hpp"
#include "firmware/model/line_format.hpp"
#include "firmware/time.hpp"
#include "hal/pl011/uart_rate.hpp"
#include "hal/registers/register.hpp"

namespace ex9000::hal::pl011 {

/// `base`: of the registers; `clock`: of the UART, in Hz; `Transceiver`: `start()` turns the RS-485 driver
/// off, `drive(bool on)` on or off, `low()` see hal/serial_line.hpp; `EndTimer`: its own one-shot timer,
/// whose interrupt calls `on_end_timer`.
///
/// The FIFOs stay off: each byte causes an interrupt when it arrives, so the silence after it can be
/// measured. The price is an overrun if an interrupt is late by more than a character time. The main loop
/// writes `begun_`, the interrupts `ended_` and `burst_`; the driver is on only while `sending()`.
template <std::uint32_t base, std::uint32_t clock, class Transceiver, class EndTimer>
class Uart {
  static_assert(largest_baud_error(clock) < kTolerableBaudError,
                "clock: the error of at least one baud rate is 1 % or more; it must be less than 1 %");

 public:
  static void start() { Transceiver::start(); }

  // --- the functions of hal/serial_line.hpp ---

  /// The UART reports a byte in the middle of its first stop bit.
  static LineTiming timing(std::uint32_t baud, LineFormat format) {
    return kStrictGaps ? LineTiming::strictly_reported_in_stop_bit(baud, format)
                       : LineTiming::reported_in_stop_bit(baud, format);
  }

  void open(std::uint32_t baud, LineFormat format) {
    constexpr std::uint32_t kMicroseconds = 1'000'000;
    const std::uint32_t divisor = baud_divisor(clock, baud);
    bit_ = Duration(kMicroseconds / baud + 1U);
    character_ = Duration(bits_of_character(format) * kMicroseconds / baud + 1U);
    kControl.write({});
    kIntegerDivisor.write(Bits<IntegerDivisor>(divisor >> 6U));
    kFractionalDivisor.write(Bits<FractionalDivisor>(divisor & 0x3FU));
    kLineControl.write(line_control(format));  // must follow the divisors, because this write activates them
    kInterruptMask.write(kReceived | kTransmitted);
    kControl.write(kEnable | kTransmitEnable | kReceiveEnable);
  }

  void send(Bytes bytes) {
    rest_.set_in_main_loop({bytes.begin() + 1, bytes.end()});
    kInterruptMask.write(kTransmitted);  // bytes that are received from now on are the echo
    begun_.store_in_main_loop(begun_.load() + 1U);
    begin(bytes[0]);
  }
  void send_in_interrupt(Bytes bytes) {
    rest_.in_interrupt() = {bytes.begin() + 1, bytes.end()};
    kInterruptMask.write(kTransmitted);
    burst_.store_in_interrupt(true);
    begin(bytes[0]);
  }

  [[nodiscard, gnu::always_inline]] bool sending() const {
    return begun_.load() != ended_.load() || burst_.load();
  }
  [[nodiscard]] static bool low() { return Transceiver::low(); }

  // --- interrupts ---

  template <class Deliver>
  void on_interrupt(Deliver deliver) {
    const Bits<MaskedInterrupts> why = kMaskedInterrupts.read();
    if (why.has(kWasReceived)) {
      // The receiver has only one byte; its read clears the flag. A transmit flag causes another interrupt.
      const Bits<Data> data = kData.read();
      deliver(static_cast<std::uint8_t>(data.value()), status_of(data));
    } else if (why.has(kWasTransmitted)) {
      kInterruptClear.write(kTransmittedClear);
      take_echo();
      send_next();
    }
  }

  /// A PL011 has no interrupt for the end of a transmission, so this checks the busy flag, first about a
  /// character time after the beginning of the last byte.
  bool on_end_timer() {
    if (kFlags.read().has(kBusy)) {
      EndTimer::restart(bit_);
      return false;
    }
    take_echo();
    kInterruptMask.write(kReceived | kTransmitted);
    Transceiver::drive(false);  // must follow the write of the mask, because a master may send now
    ended_.store_in_interrupt(begun_.load());
    burst_.store_in_interrupt(false);
    return true;
  }

 private:
  struct Data;
  struct Flags;
  struct IntegerDivisor;
  struct FractionalDivisor;
  struct LineControl;
  struct Control;
  struct InterruptMask;
  struct MaskedInterrupts;
  struct InterruptClear;

  static constexpr Register<Data> kData{base + 0x000};
  static constexpr Register<Flags> kFlags{base + 0x018};
  static constexpr Register<IntegerDivisor> kIntegerDivisor{base + 0x024};
  static constexpr Register<FractionalDivisor> kFractionalDivisor{base + 0x028};
  static constexpr Register<LineControl> kLineControl{base + 0x02C};
  static constexpr Register<Control> kControl{base + 0x030};
  static constexpr Register<InterruptMask> kInterruptMask{base + 0x038};
  static constexpr Register<MaskedInterrupts> kMaskedInterrupts{base + 0x040};
  static constexpr Register<InterruptClear> kInterruptClear{base + 0x044};

  static constexpr Bits<Data> kFramingError{1U << 8U};
  static constexpr Bits<Data> kParityError{1U << 9U};
  static constexpr Bits<Data> kBreakError{1U << 10U};
  static constexpr Bits<Data> kOverrunError{1U << 11U};
  static constexpr Bits<Flags> kBusy{1U << 3U};
  static constexpr Bits<Flags> kReceiverEmpty{1U << 4U};
  static constexpr Bits<LineControl> kParityEnable{1U << 1U};
  static constexpr Bits<LineControl> kEvenParity{1U << 2U};
  static constexpr Bits<LineControl> kTwoStopBits{1U << 3U};
  static constexpr Bits<LineControl> kEightBits{0x3U << 5U};
  static constexpr Bits<Control> kEnable{1U << 0U};
  static constexpr Bits<Control> kTransmitEnable{1U << 8U};
  static constexpr Bits<Control> kReceiveEnable{1U << 9U};
  static constexpr Bits<InterruptMask> kReceived{1U << 4U};
  static constexpr Bits<InterruptMask> kTransmitted{1U << 5U};
  static constexpr Bits<InterruptClear> kTransmittedClear{1U << 5U};
  static constexpr Bits<MaskedInterrupts> kWasReceived{1U << 4U};
  static constexpr Bits<MaskedInterrupts> kWasTransmitted{1U << 5U};

  /// 8 data bits, and the FIFOs off.
  static Bits<LineControl> line_control(LineFormat format) {
    switch (format) {
      case LineFormat::k8N1:
        break;
      case LineFormat::k8N2:
        return kEightBits | kTwoStopBits;
      case LineFormat::k8E1:
        return kEightBits | kParityEnable | kEvenParity;
      case LineFormat::k8O1:
        return kEightBits | kParityEnable;
    }
    return kEightBits;
  }

  static ByteStatus status_of(Bits<Data> data) {
    if (!data.has(kFramingError | kParityError | kBreakError | kOverrunError)) {
      return ByteStatus::Good;
    }
    if (data.has(kOverrunError)) {
      return ByteStatus::Overrun;
    }
    if (data.has(kBreakError)) {
      return ByteStatus::Break;
    }
    return data.has(kFramingError) ? ByteStatus::FramingError : ByteStatus::ParityError;
  }

  static void begin(std::uint8_t first) {
    Transceiver::drive(true);
    kData.write(Bits<Data>(first));
  }

  /// Empties the receiver for the next byte.
  static void take_echo() {
    if (!kFlags.read().has(kReceiverEmpty)) {
      static_cast<void>(kData.read());
    }
  }

  /// When the previous byte has moved from the transmit holding register to the shift register.
  void send_next() {
    Rest& rest = rest_.in_interrupt();
    if (rest.next != rest.end) {
      kData.write(Bits<Data>(*rest.next++));
    } else if (sending()) {
      EndTimer::restart(character_);
    }
  }

  struct Rest {
    const std::uint8_t* next = nullptr;
    const std::uint8_t* end = nullptr;
  };

  Duration bit_;        ///< duration of a bit, rounded up
  Duration character_;  ///< duration of a character, rounded up
  /// Not yet written to the UART. A store to `begun_` hands it to the interrupts, one to `ended_` back.
  HandedToInterrupt<Rest> rest_;
  WrittenByMainLoop<std::uint32_t> begun_;
  WrittenByInterrupt<std::uint32_t> ended_;
  WrittenByInterrupt<bool> burst_;  ///< an interrupt has begun to send
};

}  // namespace ex9000::hal::pl011
