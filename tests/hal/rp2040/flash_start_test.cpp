// Tests that the flash driver resumes, at its start, an erase that was suspended before a reset of the MCU.
// Source: W25Q16JV data sheet, 8.2 (Erase / Program Resume, 7Ah). Images in the emulator test the rest of the
// driver.
#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "hal/rp2040/flash.hpp"
#include "tests/hal/rp2040/bus.hpp"

namespace ex9000 {
namespace {

/// Records the bytes to the flash. The SSI always has a received byte.
class Ssi final : public rp2040_model::Bus {
 public:
  std::uint32_t read(std::uint32_t /*address*/) override { return 0x0E; }
  void write(std::uint32_t address, std::uint32_t value) override {
    constexpr std::uint32_t kData = 0x1800'0060;
    if (address == kData) {
      sent.push_back(value);
    }
  }

  std::vector<std::uint32_t> sent;
};

TEST(FlashStart, ResumesASuspendedErase) {
  Ssi ssi;
  hal::rp2040::Flash::start();
  EXPECT_EQ(ssi.sent, std::vector<std::uint32_t>{0x7A});
}

}  // namespace
}  // namespace ex9000
