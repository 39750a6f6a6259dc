// AT24C64 on an I2C bus. Source: Atmel AT24C64 data sheet (doc. 0336), "write operations", "read operations".
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "firmware/bytes.hpp"
#include "firmware/time.hpp"
#include "hal/i2c_master.hpp"

namespace ex9000::hal {

/// 8 KiB in pages of 32 bytes. Functions: hal/eeprom.hpp; `Master`: see I2cTransfer. While it programs a
/// page, the EEPROM acknowledges nothing: the driver repeats the device address until it does, or until the
/// timeout. A read has a STOP between memory address and data, because not every master supports a repeated
/// START; the EEPROM keeps the address.
template <class Master>
class At24c {
 public:
  Master& master() { return master_; }

  void start_read(std::uint16_t address, MutableBytes destination, Time now) {
    destination_ = destination;
    begin(Step::Addressing, address, now);
  }

  void start_write(std::uint16_t address, Bytes source, Time now) {
    rest_ = source;
    begin(Step::Writing, address, now);
  }

  bool poll(Time now) {
    const bool again = master_.poll(now);
    if (step_ != Step::Idle && !master_.busy()) {
      next(now);
    }
    return again;
  }

  [[nodiscard]] bool busy() const { return step_ != Step::Idle; }
  [[nodiscard]] bool succeeded() const { return succeeded_; }

 private:
  enum class Step : std::uint8_t {
    Idle,
    Addressing,  ///< sends the memory address for a read
    Reading,
    Writing,      ///< sends bytes of one page
    Programming,  ///< waits until the EEPROM acknowledges again
  };

  static constexpr std::uint8_t kDevice = 0x50;  // A2, A1 and A0 are connected to GND
  static constexpr std::size_t kPage = 32;
  /// For an acknowledgement. A page takes at most 10 ms; the first read after a reset may wait for one too.
  static constexpr Duration kAnswerTimeout = milliseconds(12);

  void begin(Step step, std::uint16_t address, Time now) {
    step_ = step;
    header_ = {static_cast<std::uint8_t>(address >> 8U), static_cast<std::uint8_t>(address)};
    answer_deadline_.set(now + kAnswerTimeout);
    transfer(now);
  }

  /// Bytes to write to the current page.
  [[nodiscard]] std::size_t chunk() const {
    const std::size_t room = kPage - header_[1] % kPage;
    return rest_.size < room ? rest_.size : room;
  }

  [[gnu::noinline]] void transfer(Time now) {  // the driver of the bus is large, and there are five callers
    // This polls after the bytes of a page: the device address and the first byte of the memory address write
    // nothing. Once the EEPROM acknowledges both, the page is programmed.
    transfer_.device = kDevice;
    transfer_.header = {header_.data(), step_ == Step::Programming ? 1U : step_ == Step::Reading ? 0U : 2U};
    transfer_.source = step_ == Step::Writing ? rest_.first(chunk()) : Bytes();
    transfer_.destination = destination_;
    master_.begin(transfer_, now);
  }

  void next(Time now) {
    if (master_.result() == I2cResult::NoAcknowledge && !answer_deadline_.reached(now)) {
      transfer(now);
      return;
    }
    if (master_.result() != I2cResult::Done) {
      finish(false);
      return;
    }
    switch (step_) {
      case Step::Addressing:
        step_ = Step::Reading;
        transfer(now);
        break;
      case Step::Writing:
        step_ = Step::Programming;
        answer_deadline_.set(now + kAnswerTimeout);
        transfer(now);
        break;
      case Step::Programming:
        next_page(now);
        break;
      case Step::Reading:
      case Step::Idle:
        finish(true);
        break;
    }
  }

  void next_page(Time now) {
    const std::size_t written = chunk();
    if (rest_.size == written) {
      finish(true);
      return;
    }
    rest_ = rest_.from(written);
    begin(Step::Writing, static_cast<std::uint16_t>((std::size_t{header_[0]} << 8U) + header_[1] + written),
          now);
  }

  void finish(bool succeeded) {
    succeeded_ = succeeded;
    step_ = Step::Idle;
  }

  Master master_;
  Step step_ = Step::Idle;
  bool succeeded_ = false;
  std::array<std::uint8_t, 2> header_{};
  Bytes rest_;
  MutableBytes destination_;
  Deadline answer_deadline_;
  I2cTransfer transfer_;
};

}  // namespace ex9000::hal
