// Tests the flash driver on a model of the SSI and of a W25Q16JV. Sources: RP2040 data sheet, 4.10; W25Q16JV
// data sheet, 8.2.
#include <gtest/gtest.h>

#include <algorithm>
#include <deque>
#include <stdexcept>
#include <vector>

#include "hal/rp2040/flash.hpp"
#include "tests/hal/rp2040/bus.hpp"

namespace ex9000 {
namespace {

using hal::rp2040::Flash;

/// A flash chip. It throws an exception for some errors of the driver, for example for a program operation
/// without Write Enable.
class Chip {
 public:
  static constexpr std::size_t kSize = 2 * 1024 * 1024;

  void select(bool on) {
    if (on && selected_) {
      throw std::runtime_error("the previous command has not ended");
    }
    if (!on && selected_) {
      execute();
    }
    selected_ = on;
    bytes_.clear();
  }
  std::uint8_t exchange(std::uint8_t byte) {
    if (!selected_) {
      throw std::runtime_error("a byte without chip select");
    }
    bytes_.push_back(byte);
    if (bytes_[0] == 0x05) {
      return static_cast<std::uint8_t>((busy ? 1U : 0U) | (write_enabled ? 2U : 0U));
    }
    if (busy && bytes_[0] != 0x75 && bytes_[0] != 0x7A) {
      throw std::runtime_error("a command while the flash is busy");
    }
    return bytes_[0] == 0x03 && bytes_.size() > 4 ? content.at(address() + bytes_.size() - 5) : 0xFF;
  }
  void complete() {
    busy = false;
    suspended = false;
  }

  std::vector<std::uint8_t> content = std::vector<std::uint8_t>(kSize, 0xFF);
  bool busy = false;
  bool suspended = false;
  bool write_enabled = false;

 private:
  [[nodiscard]] std::size_t address() const {
    return std::size_t{bytes_[1]} << 16U | std::size_t{bytes_[2]} << 8U | bytes_[3];
  }
  void execute() {
    switch (bytes_.empty() ? 0x05 : bytes_[0]) {
      case 0x03:
      case 0x05:
        break;
      case 0x06:
        write_enabled = true;
        break;
      case 0x02:
        program();
        break;
      case 0x20:
        erase();
        break;
      case 0x75:
        suspended = busy;
        busy = false;
        break;
      case 0x7A:
        busy = busy || suspended;
        suspended = false;
        break;
      default:
        throw std::runtime_error("an unknown command");
    }
  }
  void begin() {
    if (!write_enabled) {
      throw std::runtime_error("no Write Enable");
    }
    write_enabled = false;
    busy = true;
  }
  void program() {
    begin();
    for (std::size_t i = 4; i < bytes_.size(); ++i) {
      content.at(address() + i - 4) &= bytes_[i];
    }
  }
  void erase() {
    begin();
    if (bytes_.size() != 4) {
      throw std::runtime_error("an erase with an incomplete address, or with data");
    }
    const std::size_t first = address() / hal::kFlashSector * hal::kFlashSector;
    std::fill_n(content.begin() + static_cast<std::ptrdiff_t>(first), hal::kFlashSector, std::uint8_t{0xFF});
  }

  bool selected_ = false;
  std::vector<std::uint8_t> bytes_;
};

/// A model of the chip-select pin and of the SSI, in the mode in which the SSI receives a byte for each byte
/// that it sends.
class Ssi final : public rp2040_model::Bus {
 public:
  std::uint32_t read(std::uint32_t address) override {
    switch (address) {
      case 0x1800'0028:
        return received_.empty() ? 0x06 : 0x0E;
      case 0x1800'0060: {
        const std::uint8_t byte = received_.at(0);
        received_.pop_front();
        return byte;
      }
      case 0x4001'800C:
        return select_control_;
      default:
        throw std::runtime_error("an unknown register is read");
    }
  }
  void write(std::uint32_t address, std::uint32_t value) override {
    const bool is_setting = address == 0x1800'0000 || address == 0x1800'0014;
    if (is_setting && enabled_) {
      throw std::runtime_error("a setting changes while the SSI is enabled");
    }
    switch (address) {
      case 0x1800'0000:
        EXPECT_EQ(value, 7U << 16U) << "8 bits, both directions";
        break;
      case 0x1800'0008:
        enabled_ = value != 0;
        break;
      case 0x1800'0010:
        EXPECT_EQ(value, 1U);
        break;
      case 0x1800'0014:
        EXPECT_EQ(value % 2, 0U);
        EXPECT_GE(value, 4U) << "the flash allows 50 MHz for Read Data";
        divider_ = value;
        break;
      case 0x1800'0060:
        if (!enabled_ || divider_ == 0 || received_.size() == 16) {
          throw std::runtime_error("the SSI is off or has no clock, or a byte is lost");
        }
        received_.push_back(chip.exchange(static_cast<std::uint8_t>(value)));
        break;
      case 0x4001'800C:
        if (value != 2U << 8U && value != 3U << 8U) {
          throw std::runtime_error("chip select is neither low nor high");
        }
        select_control_ = value;
        chip.select(value == 2U << 8U);
        break;
      default:
        throw std::runtime_error("an unknown register is written");
    }
  }

  Chip chip;

 private:
  bool enabled_ = true;
  std::uint32_t divider_ = 0;
  std::uint32_t select_control_ = 0;
  std::deque<std::uint8_t> received_;
};

class FlashDriver : public testing::Test {
 protected:
  FlashDriver() { Flash::start(); }

  std::vector<std::uint8_t> read(std::uint32_t address, std::size_t size) {
    std::vector<std::uint8_t> bytes(size);
    Flash::read(address, {bytes.data(), bytes.size()});
    return bytes;
  }
  void program(std::uint32_t address, const std::vector<std::uint8_t>& bytes) {
    Flash::start_program(address, {bytes.data(), bytes.size()});
    EXPECT_TRUE(Flash::busy());
    ssi_.chip.complete();
    EXPECT_FALSE(Flash::busy());
  }

  Ssi ssi_;
};

constexpr std::uint32_t kPlace = 0x1F'1234;

TEST_F(FlashDriver, ReadsWhatItHasProgrammed) {
  const std::vector<std::uint8_t> bytes{1, 2, 3, 0xFE};
  program(kPlace, bytes);
  EXPECT_EQ(read(kPlace, 4), bytes);
  EXPECT_EQ(read(kPlace - 1, 1), std::vector<std::uint8_t>{0xFF});
  EXPECT_EQ(read(kPlace + 4, 1), std::vector<std::uint8_t>{0xFF});
}

TEST_F(FlashDriver, TheWriteEnableBitDoesNotMeanThatTheFlashIsBusy) {
  ssi_.chip.write_enabled = true;
  EXPECT_FALSE(Flash::busy());
}

TEST_F(FlashDriver, ProgramsAWholePage) {
  std::vector<std::uint8_t> page;
  for (unsigned i = 0; i < hal::kFlashPage; ++i) {
    page.push_back(static_cast<std::uint8_t>(i));
  }
  program(0x1F'0100, page);
  EXPECT_EQ(read(0x1F'0100, hal::kFlashPage), page);
}

TEST_F(FlashDriver, ErasesOnlyTheSectorOfTheAddress) {
  program(0x1F'0FFF, {0});
  program(0x1F'1000, {0});
  program(0x1F'1FFF, {0});
  program(0x1F'2000, {0});
  Flash::start_erase(kPlace);
  EXPECT_TRUE(Flash::busy());
  ssi_.chip.complete();
  EXPECT_EQ(read(0x1F'0FFF, 2), (std::vector<std::uint8_t>{0, 0xFF}));
  EXPECT_EQ(read(0x1F'1FFF, 2), (std::vector<std::uint8_t>{0xFF, 0}));
}

TEST_F(FlashDriver, ReadsAnotherSectorWhileAnEraseIsSuspended) {
  program(0x1F'0000, {7});
  Flash::start_erase(kPlace);
  Flash::suspend();
  EXPECT_FALSE(Flash::busy());
  EXPECT_EQ(read(0x1F'0000, 1), std::vector<std::uint8_t>{7});
  Flash::resume();
  EXPECT_TRUE(Flash::busy());
  ssi_.chip.complete();
  EXPECT_FALSE(Flash::busy());
}

TEST_F(FlashDriver, StartContinuesAnEraseThatIsSuspendedOrRunning) {
  Flash::start_erase(kPlace);
  Flash::suspend();
  Flash::start();
  EXPECT_TRUE(Flash::busy());
  ssi_.chip.complete();
  Flash::start_erase(kPlace);
  Flash::start();
  EXPECT_TRUE(Flash::busy());
}

}  // namespace
}  // namespace ex9000
