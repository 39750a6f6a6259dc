// A receiver and a clock, for tests of the receiver.
#pragma once

#include <gtest/gtest.h>

#include <cstdint>
#include <optional>
#include <ostream>
#include <string_view>
#include <vector>

#include "firmware/line/receiver.hpp"
#include "tests/support/clock_at.hpp"

namespace ex9000 {

using FrameBytes = std::vector<std::uint8_t>;

inline constexpr std::uint8_t kOwn = 0x01;
inline constexpr std::uint32_t kBaud = 9600;
inline constexpr Duration kCharacter = Duration(1042);

inline const FrameBytes kChannel0On{0x01, 0x05, 0x00, 0x00, 0xFF, 0x00, 0x8C, 0x3A};
inline const FrameBytes kHostOk{0x01, 0x03, 0x30, 0x38, 0x00, 0x00, 0xCB, 0x07};
/// The frame for module 02 in the CRC example of Modbus over Serial Line V1.02, 6.2.2.
inline const FrameBytes kGuideExample{0x02, 0x07, 0x41, 0x12};

/// The receiver's counters for function 08 (wire.md D1), in the order of the sub-functions 0B, 0C, 0E, 0F and
/// 12.
struct Counts {
  unsigned bus_messages;
  unsigned bus_errors;
  unsigned server_messages;
  unsigned no_responses;
  unsigned overruns;

  friend bool operator==(const Counts& a, const Counts& b) {
    return a.bus_messages == b.bus_messages && a.bus_errors == b.bus_errors &&
           a.server_messages == b.server_messages && a.no_responses == b.no_responses &&
           a.overruns == b.overruns;
  }
  friend std::ostream& operator<<(std::ostream& out, const Counts& c) {
    return out << "0B " << c.bus_messages << ", 0C " << c.bus_errors << ", 0E " << c.server_messages
               << ", 0F " << c.no_responses << ", 12 " << c.overruns;
  }
};

class ReceiverTest : public testing::Test {
 protected:
  void listen(Protocol protocol, bool checksum = false) {
    receiver_.listen({protocol, checksum, LineTiming::at(kBaud, LineFormat::k8N1)});
    receiver_.answer_to(kOwn);
  }

  Duration byte(std::uint8_t value, ByteStatus status = ByteStatus::Good) {
    now_ = now_ + kCharacter;
    return receiver_.on_byte(value, status, ClockAt{now_});
  }
  void bytes(const FrameBytes& values) {
    for (const std::uint8_t value : values) {
      byte(value);
    }
  }
  void text(std::string_view characters) {
    for (const char character : characters) {
      byte(static_cast<std::uint8_t>(character));
    }
  }
  /// Lets a silence of 50 ms pass, which ends a Modbus frame. A silence does not end an ASCII frame.
  void silence() {
    now_ = now_ + milliseconds(50);
    while (!(receiver_.on_silence(now_) == Duration())) {
    }
  }
  void frame(const FrameBytes& values) {
    bytes(values);
    silence();
  }

  Counts counts() {
    LineTallies& tallies = receiver_.tallies();
    const Counts since_last{tallies.bus_messages(), tallies.bus_errors(), tallies.server_messages(),
                            tallies.no_responses(), tallies.overruns()};
    tallies.clear();
    return since_last;
  }
  /// Returns the times of the host OKs, and of the requests that count like one, since the last call; nothing
  /// if there are none.
  std::optional<HostOks::Times> host_oks() {
    HostOks& host_oks = receiver_.host_oks();
    return host_oks.waiting() ? std::optional(host_oks.take_in_main_loop()) : std::nullopt;
  }
  void expect_host_ok_at(Time time) {
    const auto times = host_oks();
    ASSERT_TRUE(times);
    EXPECT_EQ(times->first.microseconds(), time.microseconds());
    EXPECT_EQ(times->last.microseconds(), time.microseconds());
  }
  bool took_frame() {
    if (!receiver_.queue().has_frame()) {
      return false;
    }
    receiver_.queue().drop_in_main_loop();
    return true;
  }

  Receiver receiver_;
  Time now_{1000};
};

}  // namespace ex9000
