// Tests the conversion of rates against cfsetspeed of the C library, which accepts termios constants and
// rates in bits per second. Also tests the flags of line formats.
#include <gtest/gtest.h>
#include <termios.h>

#include <array>
#include <cstdint>
#include <set>

#include "sim/files_and_ports/ports/termios_rates.hpp"

namespace ex9000::sim {
namespace {

/// All rates for which Linux has a constant (asm-generic/termbits.h).
constexpr std::array<std::uint32_t, 30> kRates{
    50,     75,     110,     134,     150,     200,     300,     600,     1200,    1800,
    2400,   4800,   9600,    19200,   38400,   57600,   115200,  230400,  460800,  500000,
    576000, 921600, 1000000, 1152000, 1500000, 2000000, 2500000, 3000000, 3500000, 4000000};

/// Returns settings in which the C library has stored `rate`.
termios settings_at(std::uint32_t rate) {
  termios settings{};
  EXPECT_EQ(cfsetspeed(&settings, rate), 0) << rate;
  return settings;
}

TEST(TermiosRates, EachRateHasTheSpeedConstantOfTheCLibrary) {
  for (const std::uint32_t rate : kRates) {
    const termios settings = settings_at(rate);
    EXPECT_EQ(termios_speed(rate), cfgetospeed(&settings)) << rate;
  }
}

TEST(TermiosRates, EachRateHasADifferentSpeedConstant) {
  std::set<speed_t> speeds;
  for (const std::uint32_t rate : kRates) {
    EXPECT_TRUE(speeds.insert(termios_speed(rate).value()).second) << rate;
  }
}

TEST(TermiosRates, TheFlagsOfALineFormatAreTheStopBitsAndTheParity) {
  EXPECT_EQ(kTermiosFormat, static_cast<tcflag_t>(CSTOPB) | static_cast<tcflag_t>(PARENB) | PARODD);
}

TEST(TermiosRates, IncludeEveryBaudRateOfAModule) {
  // wire.md section 4: CC 03 to 0A.
  for (const std::uint32_t rate : {1200U, 2400U, 4800U, 9600U, 19200U, 38400U, 57600U, 115200U}) {
    EXPECT_TRUE(termios_speed(rate)) << rate;
  }
}

TEST(TermiosRates, OtherRatesHaveNoSpeedConstant) {
  for (const std::uint32_t rate : {0U, 1U, 49U, 9601U, 57601U, 14400U, 250000U, 4000001U, 0xFFFF'FFFFU}) {
    EXPECT_FALSE(termios_speed(rate)) << rate;
  }
}

// POSIX.1-2017, 11.2.4.
TEST(TermiosFormats, HaveTheFlagsOfTheirParityAndStopBits) {
  EXPECT_EQ(termios_format(LineFormat::k8N1), 0U);
  EXPECT_EQ(termios_format(LineFormat::k8N2), static_cast<tcflag_t>(CSTOPB));
  EXPECT_EQ(termios_format(LineFormat::k8E1), static_cast<tcflag_t>(PARENB));
  EXPECT_EQ(termios_format(LineFormat::k8O1), static_cast<tcflag_t>(PARENB | PARODD));
}

}  // namespace
}  // namespace ex9000::sim
