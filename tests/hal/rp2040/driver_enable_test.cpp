// Tests that one write turns the RS-485 driver on or off, because the main loop turns it on, and an interrupt
// turns it off. Sources: RP2040 data sheet, 2.3.1.7 (GPIO_OUT_SET, GPIO_OUT_CLR); LM3S6965 data sheet, 8.3.1
// (data register operation).
#include <gtest/gtest.h>

#include <stdexcept>
#include <utility>
#include <vector>

#include "hal/pins/single_pins.hpp"
#include "hal/rp2040/gpio.hpp"
#include "hal/stellaris/gpio.hpp"
#include "tests/hal/rp2040/bus.hpp"

namespace ex9000 {
namespace {

using Writes = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

class OnlyWrites final : public rp2040_model::Bus {
 public:
  std::uint32_t read(std::uint32_t /*address*/) override { throw std::runtime_error("a register is read"); }
  void write(std::uint32_t address, std::uint32_t value) override { writes.emplace_back(address, value); }

  Writes writes;
};

constexpr hal::rp2040::Pin kGpio2{2};
constexpr hal::stellaris::Pin kPortC6{hal::stellaris::Port::C, 6};

TEST(DriverEnable, TakesOneWriteOnTheRp2040) {
  OnlyWrites bus;
  hal::DriverEnablePin<kGpio2>::drive(true);
  hal::DriverEnablePin<kGpio2>::drive(false);
  EXPECT_EQ(bus.writes, (Writes{{0xD000'0014, 1U << 2U}, {0xD000'0018, 1U << 2U}}));
}

TEST(DriverEnable, TakesOneWriteOnTheStellaris) {
  OnlyWrites bus;
  hal::DriverEnablePin<kPortC6>::drive(true);
  hal::DriverEnablePin<kPortC6>::drive(false);
  constexpr std::uint32_t kOnlyPin6 = 0x4000'6000 + (1U << 6U << 2U);
  EXPECT_EQ(bus.writes, (Writes{{kOnlyPin6, 1U << 6U}, {kOnlyPin6, 0}}));
}

}  // namespace
}  // namespace ex9000
