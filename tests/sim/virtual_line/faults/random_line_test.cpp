// Feeds an hour of noise to a module, once for each protocol and, in ASCII, also with checksums. The module
// must reply only to valid frames. Its outputs may change only because of a valid frame, an expiry of the
// host watchdog, or the end of an output's timer. The test decides without the firmware's code which frames
// are valid.
#include <gtest/gtest.h>

#include <cstdio>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/notation/module_notation.hpp"
#include "sim/virtual_line/wires/module.hpp"
#include "sim/virtual_line/wires/wires.hpp"
#include "tests/firmware/noise/onlooker.hpp"
#include "tests/oracles/reference/dcon_check.hpp"

namespace ex9000::sim {
namespace {

using std::chrono::milliseconds;
using std::chrono::nanoseconds;

constexpr VirtualTime kAnHour = std::chrono::hours(1);
constexpr VirtualTime kByte = nanoseconds(10'000'000'000 / 9600);
/// Feeds bytes to the receiver of a powered module, and checks the module's reaction.
class NoisyLine {
 public:
  explicit NoisyLine(const std::string& spec) {
    const ModuleSpec parsed = parse_module_spec(spec);
    module_.emplace(wires_, *parsed.model);
    module_->store(parsed.settings);
    onlooker_.emplace(wires_, *module_, 0);
    module_->power(true);
    wires_.run_for(milliseconds(100));
    onlooker_->start_checking();
  }

  [[nodiscard]] VirtualTime now() { return clock_.virtual_now(); }
  void run(VirtualTime time) { wires_.run_for(time); }
  /// Delivers a byte that begins now, and advances the time to its end.
  void put(std::uint8_t byte, ByteStatus status) {
    run(kByte);
    onlooker_->hears(byte, status);
    module_->receive(byte, status);
  }

  [[nodiscard]] std::uint64_t replies() const { return onlooker_->replies(); }
  [[nodiscard]] std::uint64_t requests() { return onlooker_->counts().requests; }

 private:
  VirtualClock clock_;
  Wires wires_{clock_};
  std::optional<SimulatedModule> module_;
  std::optional<noise::Onlooker> onlooker_;
};

class Noise {
 public:
  explicit Noise(std::uint32_t seed) : random_(seed) {}

  unsigned below(unsigned limit) { return static_cast<unsigned>(random_() % limit); }
  bool once_in(unsigned times) { return below(times) == 0; }
  std::uint8_t byte() { return static_cast<std::uint8_t>(random_()); }
  ByteStatus status() {
    if (!once_in(200)) {
      return ByteStatus::Good;
    }
    constexpr ByteStatus kErrors[] = {ByteStatus::FramingError, ByteStatus::Break, ByteStatus::Overrun};
    return kErrors[below(3)];
  }
  template <class Container>
  auto pick(const Container& container) {
    return container[below(static_cast<unsigned>(container.size()))];
  }

 private:
  std::mt19937 random_;
};

std::string dcon_noise(Noise& noise, bool checksum) {
  static const std::vector<std::string> commands{"$012",    "$016",  "@01",  "@01FF", "#0100AA", "#010",
                                                 "$01C",    "$01L1", "~010", "$014",  "~012",    "~**",
                                                 "#**",     "~011",  "$01F", "$01M",  "@0155",   "#011701",
                                                 "~01OABC", "$015",  "!01",  ">",     "?01$01M"};
  std::string text;
  switch (noise.below(4)) {
    case 0:
      for (unsigned i = noise.below(40); i > 0; --i) {
        text += static_cast<char>(noise.byte());
      }
      return text;
    case 1:
      for (unsigned i = noise.below(12); i > 0; --i) {
        text += noise.pick(std::string("#$%@~!>?01M26\r\n*AF"));
      }
      return text;
    default:
      text = noise.pick(commands);
      if (noise.once_in(10)) {
        text.insert(text.begin() + noise.below(static_cast<unsigned>(text.size()) + 1), 1 + noise.below(40),
                    'x');
      }
      if (checksum && !noise.once_in(5)) {
        text += reference::check_of(text);
      }
      if (noise.once_in(4)) {
        const unsigned at = noise.below(static_cast<unsigned>(text.size()));
        text[at] = static_cast<char>(static_cast<unsigned char>(text[at]) ^ (1U << noise.below(8)));
      }
      return text + (noise.once_in(8) ? "" : "\r");
  }
}

void report(const char* what, std::size_t bytes, NoisyLine& line) {
  const std::uint64_t requests = line.requests();
  std::printf("%s: %zu bytes in an hour, %llu valid requests, %llu answered\n", what, bytes,
              static_cast<unsigned long long>(requests), static_cast<unsigned long long>(line.replies()));
  // The module may lose a request that arrives while an earlier request waits for its reply. Most requests
  // arrive at other times.
  EXPECT_GT(requests, 1000U);
  EXPECT_GT(line.replies(), requests / 2);
}

void an_hour_of_dcon(bool checksum, std::uint32_t seed) {
  NoisyLine line(checksum ? "EX9055D,checksum=on" : "EX9055D");
  Noise noise(seed);
  std::size_t bytes = 0;
  while (line.now() < kAnHour && !testing::Test::HasFailure()) {
    for (const char character : dcon_noise(noise, checksum)) {
      line.put(static_cast<std::uint8_t>(character), noise.status());
      ++bytes;
    }
    if (noise.once_in(2)) {
      line.run(milliseconds(noise.below(40)));
    }
  }
  report(checksum ? "DCON with checksum" : "DCON", bytes, line);
}

std::vector<std::uint8_t> rtu_noise(Noise& noise) {
  static const std::vector<std::vector<std::uint8_t>> requests{{1, 1, 0, 0, 0, 13},
                                                               {1, 5, 0, 3, 0xFF, 0},
                                                               {1, 15, 0, 0, 0, 13, 2, 0xAA, 0x15},
                                                               {1, 3, 1, 0xE2, 0, 4},
                                                               {1, 6, 1, 0xE8, 0, 200},
                                                               {1, 8, 0, 0, 0x12, 0x34},
                                                               {1, 17},
                                                               {1, 0x2B, 0x0E, 1, 0},
                                                               {1, 0x46, 0},
                                                               {0, 5, 0, 1, 0xFF, 0},
                                                               {0, 3, 0x30, 0x38, 0, 0},
                                                               {1, 3, 0x30, 0x38, 0, 1},
                                                               {2, 1, 0, 0, 0, 13},
                                                               {1, 0x99, 1, 2},
                                                               {77, 5, 0, 0, 0xFF, 0}};
  std::vector<std::uint8_t> frame;
  if (noise.once_in(3)) {
    for (unsigned i = noise.below(noise.once_in(50) ? 300 : 20); i > 0; --i) {
      frame.push_back(noise.byte());
    }
    return frame;
  }
  frame = with_crc(noise.pick(requests));
  if (noise.once_in(4)) {
    const unsigned at = noise.below(static_cast<unsigned>(frame.size()));
    frame[at] = static_cast<std::uint8_t>(frame[at] ^ (1U << noise.below(8)));
  }
  if (noise.once_in(6)) {
    frame.insert(frame.begin(), 0x00);
  }
  if (noise.once_in(20)) {
    frame.resize(noise.below(static_cast<unsigned>(frame.size())));
  }
  return frame;
}

void an_hour_of_modbus(std::uint32_t seed) {
  NoisyLine line("EX9042D-M");
  Noise noise(seed);
  std::size_t bytes = 0;
  while (line.now() < kAnHour && !testing::Test::HasFailure()) {
    for (const std::uint8_t byte : rtu_noise(noise)) {
      line.put(byte, noise.status());
      ++bytes;
      if (noise.once_in(50)) {
        // The pause and the next byte together are shorter than T3.5.
        line.run(std::chrono::microseconds(noise.below(2900)));
      }
    }
    line.run(milliseconds(5 + noise.below(20)));
  }
  report("Modbus RTU", bytes, line);
}

TEST(RandomLine, OnlyValidRequestsInAnHourOfDconNoiseAreAnswered) { an_hour_of_dcon(false, 1); }
TEST(RandomLine, OnlyValidRequestsInAnHourOfDconNoiseWithChecksumAreAnswered) { an_hour_of_dcon(true, 2); }
TEST(RandomLine, OnlyValidRequestsInAnHourOfModbusNoiseAreAnswered) { an_hour_of_modbus(3); }

}  // namespace
}  // namespace ex9000::sim
