// Tests the times of a bus scan on the Pico in the emulator, bit by bit on the line: extensions.md, scan.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <sstream>
#include <string>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"
#include "tests/boards/pico_image.hpp"

namespace ex9000::pico {
namespace {

struct Arrival {
  unsigned byte;
  double began;  ///< in ns after the last stop bit of the request
};

class PicoScan : public PicoImage {
 protected:
  static constexpr std::uint32_t kNumber = 0x0D00A55A;

  void begin_numbered(std::uint8_t baud_code) {
    Settings settings = Settings::factory(*find_model("EX9068D-M"));
    settings.protocol = Protocol::ModbusRtu;
    settings.baud_code = baud_code;
    settings.serial_number = kNumber;
    bench_.begin_anew(*find_model("EX9068D-M"), &settings);
    bench_.set_baud(baud_rate(baud_code));
    bench_.set_format(line_format(baud_code));
    bench_.power(true);
    bench_.come_up();
    bit_ = 1e9 / baud_rate(baud_code);
    bits_to_report_ = bits_received(line_format(baud_code)) - 0.5;
  }

  std::vector<Arrival> round(std::uint8_t which) {
    bench_.execute("arrivals");
    bench_.send(with_crc({0xFD, 0x46, which}));
    const auto end = static_cast<double>(bench_.now().count());
    bench_.run_for(nanoseconds(static_cast<std::int64_t>(1000 * bit_)));
    std::istringstream text(bench_.execute("arrivals"));
    std::vector<Arrival> arrivals;
    for (std::string each; text >> each;) {
      const double middle_of_stop_bit = std::stod(each.substr(each.find('@') + 1));
      arrivals.push_back(
          {static_cast<unsigned>(std::stoul(each)), middle_of_stop_bit - bits_to_report_ * bit_ - end});
    }
    return arrivals;
  }

  double bit_ = 0;
  double bits_to_report_ = 0;
};

// A window begins at most 10 us late: the silence timer is late by up to 5 us when it detects the end of the
// request, and when it begins the window.
TEST_F(PicoScan, EachZeroIsAByteAtTheBeginningOfItsWindowAtEveryRate) {
  for (unsigned code = kFirstBaudCode; code <= kLastBaudCode; ++code) {
    const auto format = static_cast<std::uint8_t>(code % 4 << 6U);
    begin_numbered(static_cast<std::uint8_t>(format | code));
    SCOPED_TRACE(std::to_string(1e9 / bit_) + " baud, format " + std::to_string(format));
    const double first = std::max(42.0, std::ceil(800e3 / bit_)) * bit_;
    const double window = std::max(13.0, 12 + std::ceil(50e3 / bit_)) * bit_;
    std::vector<Arrival> expected;
    const std::uint32_t word = 0x6D00A55A;
    for (unsigned each = 0; each < 32; ++each) {
      if ((word >> (31 - each) & 1U) == 0) {
        expected.push_back({0xFF, first + each * window});
      }
    }
    const std::size_t bursts = expected.size();
    const auto reply = with_crc({0xFD, 0x46, 0x03, 0x0D, 0x00, 0xA5, 0x5A, 0x01});
    const unsigned character = bits_of_character(line_format(format));
    for (std::size_t i = 0; i < reply.size(); ++i) {
      expected.push_back({reply[i], first + 32 * window + static_cast<double>(i * character) * bit_});
    }
    const std::vector<Arrival> arrivals = round(0x01);
    ASSERT_EQ(arrivals.size(), expected.size());
    for (std::size_t i = 0; i < arrivals.size(); ++i) {
      EXPECT_EQ(arrivals[i].byte, expected[i].byte) << i;
      if (i <= bursts) {
        EXPECT_GE(arrivals[i].began, expected[i].began - 1e3) << i;
        EXPECT_LE(arrivals[i].began, expected[i].began + 10e3 + bit_) << i;  // the UART begins at its own bit
      }
    }
    const auto counts = bench_.counts();
    EXPECT_EQ(counts.at("drives"), static_cast<long>(bursts) + 1);
    EXPECT_EQ(counts.at("lost") + counts.at("early") + counts.at("late"), 0);
  }
}

// The module of the master that sends FF in a window of a 1 wins.
TEST_F(PicoScan, AByteInTheWindowOfAOneSilencesTheModule) {
  begin_numbered(0x06);
  bench_.execute("arrivals");
  bench_.send(with_crc({0xFD, 0x46, 0x01}));
  const auto bits = [&](double count) { return nanoseconds(static_cast<std::int64_t>(count * bit_)); };
  bench_.run_for(bits(42 + 13));  // the second window is that of a 1
  bench_.send({0xFF});
  bench_.run_for(bits(1000));
  std::istringstream text(bench_.execute("arrivals"));
  std::vector<std::string> bytes;
  for (std::string each; text >> each;) {
    bytes.push_back(each);
  }
  EXPECT_EQ(bytes.size(), 1U) << "only the byte of the first window";
  EXPECT_EQ(round(0x02).size(), 19U + 10U) << "the module is still unscanned";
}

// The level of the pin tells that another module has begun.
TEST_F(PicoScan, AStartBitOnTheLineKeepsTheModuleSilentInItsWindowButItHasNotLost) {
  begin_numbered(0x03);  // 1200 baud: a bit is longer than the emulator's steps
  bench_.execute("arrivals");
  bench_.send(with_crc({0xFD, 0x46, 0x01}));
  const auto bits = [&](double count) { return nanoseconds(static_cast<std::int64_t>(count * bit_)); };
  bench_.run_for(bits(41.8));
  bench_.send({0xFF});
  bench_.run_for(bits(1000));
  std::istringstream text(bench_.execute("arrivals"));
  std::size_t bytes = 0;
  for (std::string each; text >> each;) {
    ++bytes;
  }
  EXPECT_EQ(bytes, 18U + 10U);
}

}  // namespace
}  // namespace ex9000::pico
