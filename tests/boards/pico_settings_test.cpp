// Tests the images for the Pico that store their settings in the flash: requests and pulses during the
// programming and the erasing of the flash, the duration of a store, power failures, a reset during an erase,
// and the duration of a start. Also tests an update of the firmware, with the settings in the flash and with
// the settings in the EEPROM.
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <map>
#include <random>
#include <string>
#include <vector>

#include "boards/pico/board.hpp"
#include "firmware/model/baud.hpp"
#include "sim/app/play/modbus_frame.hpp"
#include "tests/firmware/settings/stored_bytes.hpp"
#include "tests/rp2040/pico_bench.hpp"
#include "tests/support/settings_reader.hpp"

namespace ex9000::pico {
namespace {

using play::Bytes;
using std::chrono::microseconds;
using std::chrono::milliseconds;
using std::chrono::nanoseconds;

// wire.md sections 2 and 7
constexpr milliseconds kComingUp{100};
constexpr milliseconds kLatestReply{20};
constexpr milliseconds kLatestReplyToAStore{200};

constexpr std::uint32_t kBaud = 115200;
constexpr nanoseconds kBit(1'000'000'000 / kBaud);
/// The silence before a request: 1.75 ms (Modbus over Serial Line V1.02, 2.5.1.1).
constexpr microseconds kSilence{1750};

constexpr std::uint8_t kAddress = 1;
/// 0D00 and the CRC-16 of the unique id that tests/rp2040/flash_chip.js has (extensions.md, identity).
constexpr std::uint32_t kNumberOfThePico = 0x0D008A5D;
constexpr unsigned kInputs = 8;

/// Returns the request that stores a timeout of the host watchdog. The reply has the same bytes.
Bytes store_of(std::uint8_t timeout) { return with_crc({kAddress, 6, 0x01, 0xE8, 0, timeout}); }

class PicoSettings : public testing::Test {
 protected:
  static constexpr std::uint8_t kFirstTimeout = 0xFF;

  PicoSettings() : settings_(Settings::factory(model_)) {
    while (baud_rate(settings_.baud_code) != kBaud) {
      ++settings_.baud_code;
    }
  }

  /// Provides a new board, whose supply is off. Its module and its master use kBaud.
  void prepare() {
    bench_.begin_anew(model_, &settings_);
    bench_.set_baud(kBaud);
  }
  void begin() {
    prepare();
    start();
  }
  void start() {
    bench_.power(true);
    bench_.run_for(kComingUp);
    bench_.heard();
  }
  void cut() {
    bench_.power(false);
    bench_.run_for(milliseconds(10));
  }

  /// Sends a request after a silence, and returns the first `size` bytes of the reply, or fewer if no more
  /// arrive in time. If `size` bytes arrive, sets `waited_` to the time from the end of the request to the
  /// start of the reply; otherwise `waited_` is wrong. Checks that `waited_` is at least the silence.
  Bytes ask(const Bytes& request, std::size_t size) {
    bench_.run_for(kSilence);
    bench_.send(request);
    const nanoseconds end = bench_.now();
    Bytes reply = bench_.receive(size, 2 * kLatestReplyToAStore);
    waited_ = bench_.now() - end - static_cast<int>(size) * 10 * kBit + kBit / 2;
    EXPECT_GE(waited_, kSilence) << "the reply begins before the silence after the request has ended";
    return reply;
  }
  void expect_store(std::uint8_t timeout) {
    ASSERT_EQ(ask(store_of(timeout), 8), store_of(timeout));
    ASSERT_LE(waited_, kLatestReplyToAStore);
  }
  unsigned stored_timeout() {
    const Bytes reply = ask(with_crc({kAddress, 3, 0x01, 0xE8, 0, 1}), 7);
    EXPECT_LE(waited_, kLatestReply);
    EXPECT_EQ(reply.size(), 7U);
    return reply.size() == 7U ? reply[4] : 0U;
  }
  long erases() { return bench_.counts().at("erases"); }

  const Model& model_ = *find_model("EX9052D-M");
  Settings settings_;
  PicoBench bench_;
  nanoseconds waited_{};
};

/// Returns the counters of all inputs, from the reply to a request for them.
std::vector<unsigned> counters_in(const Bytes& reply) {
  constexpr std::size_t kHead = 3;
  std::vector<unsigned> counters;
  for (std::size_t channel = 0; channel < kInputs; ++channel) {
    counters.push_back(reply.at(kHead + 2 * channel) * 256U + reply.at(kHead + 2 * channel + 1));
  }
  return counters;
}

TEST_F(PicoSettings, NoRequestAndNoPulseIsLostDuringContinuousStores) {
  begin();
  constexpr unsigned kRequests = 10'000;
  constexpr unsigned kPulses = 32'000;
  constexpr unsigned kEdgeToEdge = 1'000'000;  // ns
  constexpr unsigned kLaterPerChannel = 7'000;
  for (unsigned channel = 0; channel < kInputs; ++channel) {
    bench_.execute("train " + std::to_string(board::kInputs[0].first_pin + channel) + " " +
                   std::to_string(kPulses) + " " + std::to_string(kEdgeToEdge + kLaterPerChannel * channel));
  }
  const Bytes read_counters = with_crc({kAddress, 4, 0, 0, 0, kInputs});
  constexpr std::size_t kReplySize = 3 + 2 * kInputs + 2;
  std::vector<unsigned> counters(kInputs);
  nanoseconds longest_store{};
  nanoseconds longest_read{};
  for (unsigned i = 0; i < kRequests / 2; ++i) {
    ASSERT_NO_FATAL_FAILURE(expect_store(static_cast<std::uint8_t>(1 + i % 200))) << i;
    longest_store = std::max(longest_store, waited_);
    const Bytes reply = ask(read_counters, kReplySize);
    ASSERT_EQ(reply.size(), kReplySize) << i;
    ASSERT_EQ(reply, with_crc({reply.begin(), reply.end() - 2})) << i;
    ASSERT_LE(waited_, kLatestReply) << i;
    longest_read = std::max(longest_read, waited_);
    const std::vector<unsigned> before = counters;
    counters = counters_in(reply);
    for (unsigned channel = 0; channel < kInputs; ++channel) {
      ASSERT_GE(counters[channel], before[channel]) << i;
    }
  }
  const nanoseconds end(2ULL * kPulses * (kEdgeToEdge + kLaterPerChannel * kInputs));
  EXPECT_LT(bench_.now(), end) << "there were no pulses during the last requests";
  std::printf("%u requests, %ld erases; longest turn-around: %.1f ms after a store, %.2f ms after a read\n",
              kRequests, erases(), static_cast<double>(longest_store.count()) / 1e6,
              static_cast<double>(longest_read.count()) / 1e6);
  EXPECT_GE(erases(), static_cast<long>(kRequests / 2 / 31));  // a sector has room for 31 records
  bench_.run_for(end + milliseconds(100) - bench_.now());
  EXPECT_EQ(counters_in(ask(read_counters, kReplySize)), std::vector<unsigned>(kInputs, kPulses));
  for (const char* wrong : {"lost", "early", "late", "framing", "shorts", "timeouts", "requests"}) {
    EXPECT_EQ(bench_.counts().at(wrong), 0) << wrong;
  }
}

TEST_F(PicoSettings, TheModuleRepliesInTimeToStoresHalfASecondApartWithTheSlowestFlash) {
  prepare();
  bench_.forget_erased_sectors();
  bench_.execute("flash-times 400000000 3000000");
  start();
  constexpr int kStores = 170;  // five sectors have room for only 155 records
  nanoseconds longest{};
  for (int i = 0; i < kStores; ++i) {
    // The pauses differ, so that the stores begin at different times during an erase.
    bench_.run_for(milliseconds(500 + i % 7 * 9) - kSilence);
    ASSERT_NO_FATAL_FAILURE(expect_store(static_cast<std::uint8_t>(1 + i))) << i;
    longest = std::max(longest, waited_);
  }
  std::printf("%d stores, %ld erases; longest turn-around: %.1f ms\n", kStores, erases(),
              static_cast<double>(longest.count()) / 1e6);
  // After the start, the module erases 13 of the 14 sectors, because the first sector contains the settings.
  // Later it erases one sector for each full sector.
  EXPECT_GE(erases(), 13 + kStores / 31);
}

TEST_F(PicoSettings, StoresWithoutPausesSucceedOrAreRefusedInTimeWithTheSlowestFlash) {
  begin();
  bench_.execute("flash-times 400000000 3000000");
  constexpr unsigned kStores = 800;  // the erased sectors have room for 420 records
  unsigned refused = 0;
  unsigned expected = kFirstTimeout;
  for (unsigned i = 0; i < kStores; ++i) {
    const std::uint8_t timeout = static_cast<std::uint8_t>(1 + i % 250);
    const Bytes reply = ask(store_of(timeout), 5);
    ASSERT_LE(waited_, kLatestReplyToAStore) << i;
    const bool stored = reply == Bytes{kAddress, 6, 0x01, 0xE8, 0};
    ASSERT_TRUE(stored || reply == with_crc({kAddress, 0x86, 4})) << i;
    bench_.run_for(milliseconds(1));  // the rest of the reply
    bench_.heard();
    expected = stored ? timeout : expected;
    refused += stored ? 0 : 1;
  }
  std::printf("%u stores without pauses, %u refused\n", kStores, refused);
  EXPECT_GT(refused, 0U);
  EXPECT_EQ(stored_timeout(), expected);
  cut();
  start();
  EXPECT_EQ(stored_timeout(), expected);
}

TEST_F(PicoSettings, AModuleWithAnErasedFlashStoresTheFirstCommandInTime) {
  bench_.begin_with(image_of(model_, Memory::Flash));
  start();
  const Bytes request = store_of(7);
  bench_.send(request);
  EXPECT_EQ(bench_.receive(8, kLatestReplyToAStore), request);
  EXPECT_TRUE(bench_.led());
  cut();
  start();
  bench_.send(with_crc({kAddress, 3, 0x01, 0xE8, 0, 1}));
  EXPECT_EQ(bench_.receive(7, kLatestReply), with_crc({kAddress, 3, 2, 0, 7}));
}

TEST_F(PicoSettings, AModuleWithAFullLogStartsInTime) {
  settings_.watchdog_timeout = 77;
  prepare();
  bench_.fill_log(settings_);
  start();
  EXPECT_EQ(stored_timeout(), 77U);
}

TEST_F(PicoSettings, PowerFailuresAtAnyTimeLoseNoValueThatWasStored) {
  constexpr unsigned kSeed = 1;
  std::mt19937 random(kSeed);
  prepare();
  unsigned stored = kFirstTimeout;
  unsigned next = 0;
  unsigned olds = 0;
  for (int i = 0; i < 100; ++i) {
    start();
    const unsigned found = stored_timeout();
    ASSERT_TRUE(found == stored || found == next) << "power failure " << i << ": the module has stored "
                                                  << found << "; expected " << stored << " or " << next;
    olds += found == stored ? 1 : 0;
    stored = found;
    for (std::uint64_t stores = random() % 40; stores != 0; --stores) {
      stored = 1 + stored % 250;
      ASSERT_NO_FATAL_FAILURE(expect_store(static_cast<std::uint8_t>(stored))) << i;
    }
    next = 1 + stored % 250;
    bench_.run_for(kSilence + microseconds(random() % 200'000));
    bench_.send(store_of(static_cast<std::uint8_t>(next)));
    bench_.run_for(microseconds(random() % 4'000));
    cut();
  }
  EXPECT_GT(erases(), 14);
  EXPECT_GT(olds, 10U);
  EXPECT_LT(olds, 90U);
}

TEST_F(PicoSettings, AfterAResetDuringAnEraseTheModuleStartsWhenTheEraseHasEnded) {
  constexpr const char* kUndefined = " 56832";
  constexpr milliseconds kErase{400};
  prepare();
  bench_.forget_erased_sectors();
  start();
  ASSERT_NO_FATAL_FAILURE(expect_store(7));
  bench_.execute("flash-times " + std::to_string(nanoseconds(kErase).count()) + " 400000");
  bench_.run_for(milliseconds(100));  // until the next erase has begun
  bench_.execute("write " + bench_.execute("pc") + kUndefined);
  bench_.run_for(milliseconds(20));
  EXPECT_EQ(bench_.counts().at("requests"), 1);
  bench_.run_for(kErase + kComingUp);
  EXPECT_EQ(stored_timeout(), 7U);
}

class PicoAfterAnUpdate : public testing::TestWithParam<Memory> {};

INSTANTIATE_TEST_SUITE_P(, PicoAfterAnUpdate, testing::Values(Memory::Flash, Memory::Eeprom),
                         [](const auto& memory) {
                           return memory.param == Memory::Flash ? "Flash" : "Eeprom";
                         });

// The emulator is slow, so this test uses only one model. stored_bytes_test.cpp uses all stored bytes,
// without a board.
TEST_P(PicoAfterAnUpdate, HasAllSettingsThatEarlierFirmwareHasStored) {
  unsigned updates = 0;
  for (const StoredBytes& stored : all_stored_bytes()) {
    if (stored.model->designation != "EX9055D" || stored.file.find("-9055d") == std::string::npos) {
      continue;
    }
    PicoBench bench(GetParam());
    bench.begin_anew(*stored.model, stored.memory);
    bench.set_baud(baud_rate(stored.settings.baud_code));
    bench.power(true);
    bench.run_for(kComingUp);
    const auto exchange = [&bench](const Bytes& frame) {
      bench.run_for(milliseconds(5));
      bench.send(frame);
      Bytes reply = bench.receive(1, milliseconds(50));
      const Bytes rest = bench.receive(256, milliseconds(5));
      reply.insert(reply.end(), rest.begin(), rest.end());
      return reply;
    };
    SettingsReader reader(*stored.model, FrameFormat::of(stored.settings), exchange, kNumberOfThePico);
    const auto found = reader.read(stored.settings.format);
    ASSERT_TRUE(found) << stored.file << ": the module does not reply";
    EXPECT_TRUE(*found == stored.settings) << stored.file;
    ++updates;
  }
  EXPECT_EQ(updates, 1U);
}

}  // namespace
}  // namespace ex9000::pico
