// Tests the counters of function 08: wire.md section 7 and D1.
#include <gtest/gtest.h>

#include <functional>
#include <ostream>
#include <vector>

#include "tests/firmware/core_bench.hpp"

namespace ex9000 {
namespace {

using FrameBytes = CoreBench::FrameBytes;

const FrameBytes kHostOk{0x01, 0x03, 0x30, 0x38, 0x00, 0x00};
const FrameBytes kUnknownFunction{0x01, 0x41};

/// The values of the counters of sub-functions 0B to 0F and 12. `counts` subtracts the requests that it sends
/// to read these values.
struct Counts {
  unsigned bus_messages = 0;
  unsigned bus_errors = 0;
  unsigned exceptions = 0;
  unsigned server_messages = 0;
  unsigned no_replies = 0;
  unsigned overruns = 0;

  friend bool operator==(const Counts& a, const Counts& b) {
    return a.bus_messages == b.bus_messages && a.bus_errors == b.bus_errors && a.exceptions == b.exceptions &&
           a.server_messages == b.server_messages && a.no_replies == b.no_replies && a.overruns == b.overruns;
  }
  friend std::ostream& operator<<(std::ostream& out, const Counts& c) {
    return out << "0B " << c.bus_messages << ", 0C " << c.bus_errors << ", 0D " << c.exceptions << ", 0E "
               << c.server_messages << ", 0F " << c.no_replies << ", 12 " << c.overruns;
  }
};

class Diagnosed : public testing::Test, protected CoreBench {
 protected:
  Diagnosed() : CoreBench("EX9042D-M") {}

  unsigned counter(std::uint8_t subfunction) {
    const FrameBytes reply = ask({0x01, 0x08, 0x00, subfunction, 0x00, 0x00});
    EXPECT_EQ(reply.size(), 8U);
    return reply.size() == 8 ? reply[4] * 256U + reply[5] : 0;
  }
  /// Reads all counters. Each request that reads a counter is itself a bus message and a server message. The
  /// function subtracts its own requests of this call, but not its requests of earlier calls.
  Counts counts() {
    Counts told;
    told.bus_messages = (counter(0x0B) - 1U) % 65'536U;
    told.bus_errors = counter(0x0C);
    told.exceptions = counter(0x0D);
    told.server_messages = (counter(0x0E) - 4U) % 65'536U;
    told.no_replies = counter(0x0F);
    told.overruns = counter(0x12);
    return told;
  }
  void clear() {
    EXPECT_EQ(ask({0x01, 0x08, 0x00, 0x0A, 0x00, 0x00}), with_crc({0x01, 0x08, 0x00, 0x0A, 0x00, 0x00}));
  }

  void spoil(ByteStatus status) {
    byte(0x01);
    byte(0x05, status);
    hear({0x00, 0x00});
  }
};

TEST_F(Diagnosed, EveryCounterHas16BitsAndWraps) {
  constexpr unsigned kAskedAtOnce = 6;
  clear();
  const FrameBytes refused = with_crc(kUnknownFunction);
  const FrameBytes host_ok = with_crc(kHostOk);
  unsigned rounds = 0;
  unsigned asked = 0;
  for (const unsigned until : {100U, 200U, 300U, 40'000U, 65'535U, 65'536U, 65'600U}) {
    for (; rounds < until; ++rounds) {
      hear(refused);
      ASSERT_EQ(answer().size(), 5U);
      hear(host_ok);
      byte(0x00, ByteStatus::Overrun);
      silence();
    }
    const auto wrapped = [](unsigned count) { return count % 65'536U; };
    const unsigned messages = wrapped(2 * rounds + asked);  // requests that read a counter are messages too
    EXPECT_EQ(counts(), (Counts{messages, wrapped(rounds), wrapped(rounds), messages, wrapped(rounds),
                                wrapped(rounds)}))
        << rounds;
    asked += kAskedAtOnce;
  }
}

}  // namespace
}  // namespace ex9000
