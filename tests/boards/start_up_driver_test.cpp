// Tests the start-up of images, from reset until they can receive. Most tests compare register accesses, or
// the register values after the start-up, with the data sheets. The simulated peripherals reject an access to
// a peripheral without a clock, and a wrong use of the PLL.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "firmware/model/baud.hpp"
#include "firmware/model/model.hpp"
#include "firmware/settings/settings.hpp"
#include "sim/virtual_line/wires/module.hpp"
#include "tests/boards/images_under_test.hpp"
#include "tests/mcu_model/board_bench.hpp"

namespace ex9000::registers {
namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

constexpr milliseconds kComesUpWithin{100};

class StartUp : public testing::TestWithParam<ImageName> {
 protected:
  StartUp()
      : image(image_of(GetParam().board, GetParam().model)), bench(image), model(*find_model(image.model)) {
    bench.record = true;
  }

  void come_up() {
    bench.power_on();
    bench.run_for(kComesUpWithin);
  }
  void store(const Settings& settings) { bench.memory = sim::SimulatedModule::memory_image(model, settings); }

  /// Returns the values written to a register, in order.
  [[nodiscard]] std::vector<std::uint32_t> written(std::uint32_t address) const {
    std::vector<std::uint32_t> values;
    for (const Access& access : bench.mcu->recorded()) {
      if (access.write && access.address == address) {
        values.push_back(access.value);
      }
    }
    return values;
  }
  /// The writes to a block of registers, in order: the offset and the value of each write.
  using Writes = std::vector<std::pair<std::uint32_t, std::uint32_t>>;
  [[nodiscard]] Writes writes_to(std::uint32_t base) const {
    Writes writes;
    for (const Access& access : bench.mcu->recorded()) {
      if (access.write && (access.address & ~0xFFFU) == base) {
        writes.emplace_back(access.address & 0xFFFU, access.value);
      }
    }
    return writes;
  }
  /// Returns the index, among all accesses, of the first write to `address` whose value contains at least one
  /// bit of `bits`. Returns the number of accesses if there is no such write.
  [[nodiscard]] std::size_t first_setting(std::uint32_t address, std::uint32_t bits) const {
    const auto& all = bench.mcu->recorded();
    return static_cast<std::size_t>(std::find_if(all.begin(), all.end(),
                                                 [&](const Access& each) {
                                                   return each.write && each.address == address &&
                                                          (each.value & bits) != 0;
                                                 }) -
                                    all.begin());
  }
  [[nodiscard]] bool has(PinPlace pin, std::uint32_t register_offset) {
    return (bench.mcu->port(pin.port).peek(register_offset) >> pin.pin & 1U) != 0;
  }
  UartPort& uart() { return image.uart == 0 ? bench.mcu->uart0 : bench.mcu->uart1; }

  const Image& image;
  BoardBench bench;
  const Model& model;
};

TEST_P(StartUp, SwitchesToThePllInTheDataSheetsOrderAndRunsAt50MHz) {
  come_up();
  // The writes switch the bypass on; select the crystal and switch the PLL on; set the divider; and, after
  // the lock, switch the bypass off.
  const std::vector<std::uint32_t> lm3s{0x078E'3AD1, 0x078E'0B80, 0x01CE'0B80, 0x01CE'0380};
  const std::vector<std::uint32_t> tm4c{0x078E'3AD1, 0x078E'0D40, 0x01CE'0D40, 0x01CE'0540};
  EXPECT_EQ(written(0x400F'E060), image.tm4c ? tm4c : lm3s);
  EXPECT_EQ(bench.mcu->system_control.cycle(), std::chrono::nanoseconds(20));
}

TEST_P(StartUp, IsResetByTheWatchdogIfThePllNeverLocks) {
  bench.record = false;
  bench.power_on();
  bench.mcu->system_control.set_lock_time(kNever);
  bench.mcu->set_clocks_an_access(1000);
  // The watchdog counts down from a value for 50 MHz. The clock is still the crystal's frequency divided by
  // four, so the countdown takes proportionally longer.
  bench.run_for(std::chrono::seconds(40));
  EXPECT_EQ(bench.watchdog_resets, 1U);
  bench.run_for(kComesUpWithin);
  EXPECT_TRUE(uart().enabled());
}

TEST_P(StartUp, EnablesOnlyTheClocksOfTheUsedPeripherals) {
  come_up();
  const auto gates = [this](unsigned index) { return bench.mcu->system_control.read(0x100 + 4 * index); };
  EXPECT_EQ(gates(0), 1U << 3U);
  EXPECT_EQ(gates(1), (image.tm4c ? 1U << 1U : 1U << 0U) | 1U << 12U | 1U << 16U | 1U << 17U | 1U << 18U);
  // The TM4C123 uses the ports A to F. The LM3S6965 uses the ports A to D, F and G.
  EXPECT_EQ(gates(2), image.tm4c ? 0x3FU : 0x6FU);
}

TEST_P(StartUp, KeepsTheFunctionAndThePullUpsOfTheDebugPins) {
  come_up();
  for (std::uint8_t pin = 0; pin < 4; ++pin) {
    EXPECT_TRUE(has({'C', pin}, GpioPort::kAlternate));
    EXPECT_TRUE(has({'C', pin}, GpioPort::kEnable));
    EXPECT_TRUE(has({'C', pin}, GpioPort::kPullUp));
  }
}

TEST_P(StartUp, ConfiguresOutputPinsAs8mAOutputs) {
  come_up();
  std::vector<PinPlace> outputs(image.output_pins.begin(), image.output_pins.begin() + image.outputs);
  outputs.push_back(image.driver_enable);
  outputs.push_back(image.status_led);
  for (const PinPlace pin : outputs) {
    SCOPED_TRACE(std::string(1, pin.port) + std::to_string(pin.pin));
    EXPECT_TRUE(has(pin, GpioPort::kDirection));
    EXPECT_TRUE(has(pin, GpioPort::kEnable));
    EXPECT_TRUE(has(pin, GpioPort::kDrive8));
    EXPECT_FALSE(has(pin, GpioPort::kDrive2));
    EXPECT_FALSE(has(pin, GpioPort::kAlternate));
    EXPECT_FALSE(has(pin, GpioPort::kOpenDrain));
    EXPECT_FALSE(has(pin, GpioPort::kPullUp));
    EXPECT_FALSE(has(pin, GpioPort::kMask));
  }
}

TEST_P(StartUp, ConfiguresInputPinsWithAPullToTheInactiveLevel) {
  come_up();
  for (unsigned channel = 0; channel < image.inputs; ++channel) {
    const PinPlace pin = image.input_pins.at(channel);
    SCOPED_TRACE(std::string(1, pin.port) + std::to_string(pin.pin));
    EXPECT_FALSE(has(pin, GpioPort::kDirection));
    EXPECT_TRUE(has(pin, GpioPort::kEnable));
    EXPECT_FALSE(has(pin, GpioPort::kAlternate));
    EXPECT_TRUE(has(pin, GpioPort::kPullDown));
    EXPECT_FALSE(has(pin, GpioPort::kSense)) << "must sense edges, not levels";
    EXPECT_TRUE(has(pin, GpioPort::kBothEdges));
    EXPECT_TRUE(has(pin, GpioPort::kMask));
  }
  const PinPlace init = image.init_switch;
  EXPECT_FALSE(has(init, GpioPort::kDirection));
  EXPECT_TRUE(has(init, GpioPort::kEnable));
  EXPECT_TRUE(has(init, GpioPort::kPullUp));
  EXPECT_FALSE(has(init, GpioPort::kMask));
  EXPECT_TRUE(bench.net(init).level());
}

TEST_P(StartUp, EnablesThePullsOfTheInputsAtLeastAMillisecondBeforeTheFirstReadOfTheLevels) {
  bench.power_on();
  // Without these times, nothing else delays the start.
  bench.mcu->system_control.set_crystal_start(Instant(0));
  bench.mcu->system_control.set_lock_time(Instant(0));
  bench.run_for(kComesUpWithin);
  for (unsigned channel = 0; channel < image.inputs; ++channel) {
    const PinPlace pin = image.input_pins.at(channel);
    SCOPED_TRACE(std::string(1, pin.port) + std::to_string(pin.pin));
    const std::uint32_t base = bench.mcu->port(pin.port).base();
    const std::uint32_t mask = 1U << pin.pin;
    const auto& all = bench.mcu->recorded();
    const auto read = std::find_if(all.begin(), all.end(), [&](const Access& each) {
      return !each.write && (each.address & ~0xFFFU) == base && (each.address & 0xFFFU) < 0x400 &&
             ((each.address & 0xFFFU) >> 2U & mask) != 0;
    });
    ASSERT_NE(read, all.end());
    const std::size_t enabled = first_setting(base + GpioPort::kEnable, mask);
    ASSERT_LT(enabled, all.size());
    EXPECT_GE(read->at - all.at(enabled).at, milliseconds(1));
    EXPECT_LT(first_setting(base + GpioPort::kPullDown, mask), enabled);
  }
}

TEST_P(StartUp, AssignsTheUartAndI2cPinsAsTheFamilyRequires) {
  come_up();
  for (const PinPlace pin : {image.receive, image.transmit, PinPlace{'B', 2}, PinPlace{'B', 3}}) {
    EXPECT_TRUE(has(pin, GpioPort::kAlternate));
    EXPECT_TRUE(has(pin, GpioPort::kEnable));
  }
  EXPECT_TRUE(has({'B', 3}, GpioPort::kOpenDrain));
  EXPECT_EQ(has({'B', 2}, GpioPort::kOpenDrain), !image.tm4c)
      << "the clock pin must be open drain, except on a TM4C";
  EXPECT_TRUE(has({'B', 2}, GpioPort::kPullUp));
  EXPECT_TRUE(has({'B', 3}, GpioPort::kPullUp));
  if (image.tm4c) {
    EXPECT_EQ(bench.mcu->port('C').peek(GpioPort::kControl), 0x0022'1111U);
    EXPECT_EQ(bench.mcu->port('B').peek(GpioPort::kControl), 0x0000'3300U);
  }
}

TEST_P(StartUp, SetsTheLevelOfAnOutputBeforeThePinIsEnabled) {
  come_up();
  std::vector<PinPlace> outputs(image.output_pins.begin(), image.output_pins.begin() + image.outputs);
  outputs.push_back(image.driver_enable);
  for (const PinPlace pin : outputs) {
    const std::uint32_t base = bench.mcu->port(pin.port).base();
    const std::uint32_t mask = 1U << pin.pin;
    const auto& all = bench.mcu->recorded();
    const auto data = std::find_if(all.begin(), all.end(), [&](const Access& each) {
      return each.write && (each.address & ~0xFFFU) == base && (each.address & 0xFFFU) < 0x400 &&
             ((each.address & 0xFFFU) >> 2U & mask) != 0;
    });
    ASSERT_NE(data, all.end());
    EXPECT_EQ(data->value & mask, 0U);
    EXPECT_LT(static_cast<std::size_t>(data - all.begin()), first_setting(base + GpioPort::kEnable, mask));
  }
}

TEST_P(StartUp, EnergisesNoOutputBeforeTheSettingsAreRead) {
  Settings settings = Settings::factory(model);
  settings.power_on_value = model.output_mask();
  store(settings);
  come_up();
  EXPECT_EQ(bench.outputs(), model.output_mask());
  ASSERT_NE(bench.output_came_on, kNever);
  std::size_t bytes_read = 0;
  for (const Access& access : bench.mcu->recorded()) {
    if (!access.write && access.address == I2cBlock::kBase + I2cBlock::kData) {
      ++bytes_read;
      EXPECT_LT(access.at, bench.output_came_on);
    }
  }
  EXPECT_GT(bytes_read, 16U);
}

TEST_P(StartUp, EnergisesNoOutputAndDoesNotDriveTheLineIfTheMemoryIsBlank) {
  come_up();
  EXPECT_EQ(bench.output_came_on, kNever);
  EXPECT_TRUE(bench.line.drives.empty());
  EXPECT_EQ(bench.line.bits_lost, 0U);
}

TEST_P(StartUp, SetsTheUartDivisorsOfTheDataSheetsForEachBaudRate) {
  // 50 MHz / (16 * rate): the integer part, and the fractional part rounded to 64ths.
  struct Divisors {
    std::uint32_t rate;
    std::uint32_t integer;
    std::uint32_t fraction;
  };
  constexpr std::array<Divisors, 8> kDivisors{{
      {1200, 2604, 11},  // 2604.1667
      {2400, 1302, 5},   // 1302.0833
      {4800, 651, 3},    // 651.0417
      {9600, 325, 33},   // 325.5208
      {19200, 162, 49},  // 162.7604
      {38400, 81, 24},   // 81.3802
      {57600, 54, 16},   // 54.2535
      {115200, 27, 8},   // 27.1267
  }};
  for (std::size_t i = 0; i < kDivisors.size(); ++i) {
    const Divisors& at = kDivisors.at(i);
    SCOPED_TRACE(at.rate);
    Settings settings = Settings::factory(model);
    settings.baud_code = static_cast<std::uint8_t>(kFirstBaudCode + i);
    store(settings);
    come_up();
    // The writes switch the UART off; set the two divisors; set the line control (8N1 without FIFOs), which
    // latches the divisors; enable the interrupts; and switch the UART on.
    EXPECT_EQ(writes_to(uart().base()), (Writes{{0x030, 0},
                                                {0x024, at.integer},
                                                {0x028, at.fraction},
                                                {0x02C, 0x60},
                                                {0x038, 0x30},
                                                {0x030, 0x301}}));
    const double made = 1e12 / static_cast<double>(uart().bit_time().count());
    EXPECT_NEAR(made, at.rate, at.rate * 0.001);
    bench.power_off();
  }
}

TEST_P(StartUp, EnablesOnlyTheServedInterruptsAndDoesNotNestThem) {
  come_up();
  const Core& core = bench.mcu->core;
  const bool inputs = image.inputs != 0;
  const unsigned uart_interrupt = image.tm4c ? 6 : 5;
  const unsigned other_port = image.tm4c ? 4 : 2;  // port E or C; both boards also have inputs on port B
  EXPECT_EQ(core.enabled(), 1U << uart_interrupt | 1U << 8U | 1U << 19U | 1U << 21U | 1U << 23U |
                                (inputs ? 1U << 1U | 1U << other_port : 0));
  for (unsigned interrupt = 0; interrupt < 24; ++interrupt) {
    // The UART is served after all other pending interrupts, so that a silence is reported before the byte
    // that follows the silence.
    EXPECT_EQ(core.priority(interrupt), interrupt == uart_interrupt ? 0xE0U : 0U) << interrupt;
    EXPECT_EQ(core.group(core.priority(interrupt)), 0U) << interrupt;
  }
  bench.ask("$01M");
  EXPECT_EQ(core.deepest_nesting(), 1U);
}

TEST_P(StartUp, TicksEvery10Milliseconds) {
  come_up();
  EXPECT_EQ(written(0xE000'E014), std::vector<std::uint32_t>{499'999});
  EXPECT_EQ(bench.mcu->core.tick_reload(), 499'999U);
}

TEST_P(StartUp, StartsTheWatchdogBeforeItConfiguresTheClock) {
  come_up();
  Writes writes = writes_to(WatchdogTimer::kBase);
  writes.resize(3);
  // 37,500,000 clock cycles at 50 MHz are 750 ms. The watchdog resets the microcontroller after two such
  // periods. After a reset the watchdog is not locked, so the image need not unlock it.
  EXPECT_EQ(writes, (Writes{{0x000, 37'500'000}, {0x008, 3}, {0xC00, 0}}));
  EXPECT_TRUE(bench.mcu->watchdog.locked());
  EXPECT_LT(first_setting(WatchdogTimer::kBase + WatchdogTimer::kControl, 1),
            first_setting(SystemControl::kBase + SystemControl::kRcc, 0xFFFF'FFFF));
}

TEST_P(StartUp, RunsTheI2cBusAt100kHz) {
  come_up();
  // 50 MHz / (2 * (1 + 24) * (6 + 4))
  EXPECT_EQ(written(0x4002'000C), std::vector<std::uint32_t>{24});
  EXPECT_EQ(written(0x4002'0020), std::vector<std::uint32_t>{0x10});
  EXPECT_EQ(written(0x4002'0010), std::vector<std::uint32_t>{1});
  EXPECT_EQ(bench.mcu->i2c.bit_time(), microseconds(10));
}

TEST_P(StartUp, ListensWithin100msWithASlowCrystal) {
  bench.crystal_start = milliseconds(18);
  come_up();
  EXPECT_TRUE(uart().enabled());
  EXPECT_EQ(bench.resets, 0U);
}

TEST_P(StartUp, WorksAfterRepeatedResetsDuringStartUp) {
  bench.power_on();
  for (int i = 0; i < 50; ++i) {
    bench.run_for(microseconds(731 * i));
    EXPECT_EQ(bench.output_came_on, kNever);
    bench.reset();
  }
  bench.run_for(kComesUpWithin);
  EXPECT_TRUE(uart().enabled());
  EXPECT_FALSE(bench.pins.at('B', 2).was_shorted() || bench.pins.at('B', 3).was_shorted());
}

INSTANTIATE_TEST_SUITE_P(Images, StartUp,
                         testing::Values(ImageName{"lm3s6965evb", "EX9055D"},
                                         ImageName{"lm3s6965evb", "EX9043D-M"},
                                         ImageName{"ek-tm4c123gxl", "EX9055D"},
                                         ImageName{"ek-tm4c123gxl", "EX9043D-M"}),
                         name_of);

}  // namespace
}  // namespace ex9000::registers
