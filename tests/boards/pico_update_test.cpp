// Updates an image for the Pico over its line, in the emulator: extensions.md, "Firmware update".
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <functional>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "firmware/reset_reason.hpp"
#include "firmware/update/request.hpp"
#include "firmware/update/update.hpp"
#include "sim/app/play/modbus_frame.hpp"
#include "tests/boards/pico_slots.hpp"

namespace ex9000::pico {
namespace {

using update::kBlockSize;
using update::State;

constexpr std::uint32_t kBaud = 115200;
constexpr unsigned kRegisterOfState = 0x1010;
constexpr unsigned kRegisterOfVersion = 0x0300;
constexpr unsigned kRegisterOfAction = 0x1013;
constexpr unsigned kActivate = 1;
constexpr unsigned kConfirm = 2;

void append(Bytes& bytes, std::uint32_t value, unsigned size) {
  for (unsigned i = size; i != 0; --i) {
    bytes.push_back(static_cast<std::uint8_t>(value >> (8 * (i - 1))));
  }
}

/// Adds code to the end of the image.
void replace_handler(Content& content, unsigned exception, const std::vector<std::uint16_t>& code) {
  Bytes& image = content.image;
  const auto put = [&image](std::size_t at, std::uint32_t value, unsigned bytes) {
    for (unsigned i = 0; i < bytes; ++i) {
      image[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
    }
  };
  const std::size_t at = (image.size() + 3) / 4 * 4;
  image.resize(at + 2 * code.size());
  for (std::size_t i = 0; i < code.size(); ++i) {
    put(at + 2 * i, code[i], 2);
  }
  put(4U * exception, static_cast<std::uint32_t>(board::kImageInRam + at) | 1U, 4);
}

/// In the tick, from 30 s after the reset on.
void after_30_s(Content& content, std::uint16_t instruction) {
  const std::uint32_t tick = content.handler(kSystemTick);
  replace_handler(content, kSystemTick,
                  {0x4803,          // LDR r0, =TIMERAWL
                   0x6800,          // LDR r0, [r0]
                   0x4903,          // LDR r1, =30'000'000
                   0x4288,          // CMP r0, r1
                   0xD300,          // BLO over the next instruction
                   instruction,     //
                   0x4802,          // LDR r0, =the handler of the build
                   0x4700,          // BX r0
                   0x4028, 0x4005,  // TIMERAWL
                   0xC380, 0x01C9,  // 30'000'000
                   static_cast<std::uint16_t>(tick), static_cast<std::uint16_t>(tick >> 16U)});
}

/// Drops each byte that arrives.
void hear_nothing(Content& content) {
  replace_handler(content, kUart0,
                  {0x4804,          // LDR r0, =UART0
                   0x6981,          // loop: LDR r1, [r0, #UARTFR]
                   0x06C9,          // LSLS r1, r1, #27: RXFE becomes the sign
                   0xD401,          // BMI over the next two instructions
                   0x6801,          // LDR r1, [r0, #UARTDR]
                   0xE7FA,          // B loop
                   0x4902,          // LDR r1, =all interrupts
                   0x6441,          // STR r1, [r0, #UARTICR]
                   0x4770,          // BX lr
                   0xBF00,          // NOP
                   0x4000, 0x4003,  // UART0
                   0x07FF, 0x0000});
}

class PicoUpdate : public PicoSlots {
 protected:
  PicoUpdate() : PicoSlots("EX9052D-M") { begin_modbus(); }

  /// Address 05 at kBaud, with the image of the build in slot 0.
  void begin_modbus() {
    const Model& model = *find_model("EX9052D-M");
    Settings settings = Settings::factory(model);
    settings.address = 5;
    settings.baud_code = kLastBaudCode;
    settings.fed_by_requests = true;
    bench_.begin_anew(model, &settings);
    bench_.set_baud(kBaud);
    bench_.power(true);
    bench_.come_up();
    bench_.heard();
  }

  void send(const Bytes& pdu) {
    Bytes frame{5};
    frame.insert(frame.end(), pdu.begin(), pdu.end());
    bench_.send(with_crc(frame));
  }
  /// The reply without address and CRC; empty if there is none within `patience`.
  Bytes request(const Bytes& pdu, milliseconds patience = milliseconds(20),
                const std::function<void()>& meanwhile = {}) {
    send(pdu);
    const nanoseconds end = bench_.now();
    if (meanwhile) {
      meanwhile();
    }
    Bytes reply = bench_.receive(1, patience);
    const Bytes rest = bench_.receive(256, milliseconds(1));
    reply.insert(reply.end(), rest.begin(), rest.end());
    longest_ = std::max(longest_, bench_.now() - milliseconds(1) - end);
    bench_.run_for(milliseconds(2));  // the silence
    const bool right = reply.size() >= 5 && with_crc(Bytes(reply.begin(), reply.end() - 2)) == reply;
    return right ? Bytes(reply.begin() + 1, reply.end() - 2) : Bytes();
  }
  /// -1: no reply.
  int read(unsigned address) {
    Bytes pdu{3};
    append(pdu, address, 2);
    append(pdu, 1, 2);
    const Bytes reply = request(pdu);
    return reply.size() != 4 ? -1 : reply[2] * 256 + reply[3];
  }
  unsigned next() {
    const Bytes reply = request({3, 0x10, 0x11, 0, 2});
    return reply.size() != 6 ? 0 : ex9000::Bytes{reply.data(), reply.size()}.double_word(2);
  }
  static Bytes action_pdu(unsigned action) { return {6, 0x10, 0x13, 0, static_cast<std::uint8_t>(action)}; }
  Bytes act(unsigned action) { return request(action_pdu(action)); }

  static Bytes begin_pdu(const Content& content) {
    Bytes pdu{0x10, 0x10, 0x00, 0, 16, 32};
    const update::Info info = content.slot().info;
    pdu.insert(pdu.end(), info.bytes.begin(), info.bytes.end());
    return pdu;
  }
  Bytes begin_update(const Content& content) { return request(begin_pdu(content), milliseconds(400)); }
  static Bytes block_pdu(const Content& content, std::uint32_t offset) {
    Bytes data;
    append(data, offset, 4);
    for (std::uint32_t i = offset; i < offset + kBlockSize; ++i) {
      data.push_back(i < content.image.size() ? content.image[i] : 0xFF);
    }
    append(data, update::crc32({data.data(), data.size()}), 4);
    Bytes pdu{0x10, 0x20, 0x00, 0, 68, 136};
    pdu.insert(pdu.end(), data.begin(), data.end());
    return pdu;
  }
  Bytes block(const Content& content, std::uint32_t offset, const std::function<void()>& meanwhile = {}) {
    return request(block_pdu(content, offset), milliseconds(400), meanwhile);
  }
  bool send_all(const Content& content) {
    if (begin_update(content) != Bytes{0x10, 0x10, 0x00, 0, 16}) {
      return false;
    }
    for (std::uint32_t offset = next(); offset < content.image.size(); offset += kBlockSize) {
      if (block(content, offset) != Bytes{0x10, 0x20, 0x00, 0, 68}) {
        return false;
      }
    }
    return true;
  }
  void restart() {
    bench_.come_up();
    bench_.heard();
  }

  nanoseconds longest_{0};  ///< from the end of a request to the end of its reply
};

/// Counters run, and the host watchdog is armed with 0.5 s.
TEST_F(PicoUpdate, UnderLoadNoEdgeIsLostAndNoReplyIsLate) {
  constexpr unsigned kPulses = 5;
  ASSERT_EQ(request({6, 0x01, 0xE8, 0, 5}, milliseconds(200)).size(), 5U);
  ASSERT_EQ(request({5, 0x01, 0x04, 0xFF, 0}, milliseconds(200)).size(), 5U);
  unsigned pulses = 0;
  nanoseconds longest_of_others{0};
  nanoseconds longest_of_blocks{0};
  const nanoseconds began = bench_.now();
  ASSERT_EQ(begin_update(new_).size(), 5U);
  for (std::uint32_t offset = 0; offset < new_.image.size(); offset += kBlockSize) {
    longest_ = {};
    const auto pulse = [&] {
      bench_.pulse_input(3, kPulses, std::chrono::microseconds(100));
      pulses += kPulses;
    };
    ASSERT_EQ(block(new_, offset, pulse), (Bytes{0x10, 0x20, 0x00, 0, 68})) << offset;
    longest_of_blocks = std::max(longest_of_blocks, longest_);
    longest_ = {};
    ASSERT_EQ(read(0x0003), static_cast<int>(pulses));
    longest_of_others = std::max(longest_of_others, longest_);
  }
  const nanoseconds took = bench_.now() - began;
  EXPECT_EQ(read(kRegisterOfState), static_cast<int>(State::Complete));
  EXPECT_EQ(read(0x0304), 0) << "the host watchdog has expired";
  EXPECT_LT(longest_of_others, milliseconds(20));
  EXPECT_LT(longest_of_blocks, milliseconds(400));
  std::printf(
      "%zu bytes with a poll after each block: %.2f s; longest reply to a block %.1f ms, to a poll %.1f ms\n",
      new_.image.size(), std::chrono::duration<double>(took).count(),
      std::chrono::duration<double, std::milli>(longest_of_blocks).count(),
      std::chrono::duration<double, std::milli>(longest_of_others).count());
  ASSERT_EQ(act(kActivate).size(), 5U);
  bench_.run_for(milliseconds(100));
  restart();
  EXPECT_EQ(read(kRegisterOfState), static_cast<int>(State::Unconfirmed));
  EXPECT_EQ(read(0x0301), 3);
  EXPECT_EQ(read(0x00FE), '3');  // of "D02.34"
  EXPECT_EQ(read(0x01E8), 5) << "the settings are lost";
  EXPECT_EQ(act(kConfirm).size(), 5U);
  bench_.execute("reset");
  restart();
  EXPECT_EQ(read(kRegisterOfState), static_cast<int>(State::None));
  EXPECT_EQ(read(0x00FE), '3');
}

/// EX9000_CUTS: how often. Each third cut leaves time for a whole update.
TEST_F(PicoUpdate, ThePowerMayFailAtAnyTime) {
  const char* const wanted = std::getenv("EX9000_CUTS");
  const unsigned most = wanted == nullptr ? 8 : static_cast<unsigned>(std::strtoul(wanted, nullptr, 10));
  std::mt19937 random(1);
  // The power fails while the module answers, or soon after.
  const auto send_and_run = [&](const Bytes& pdu, unsigned most_microseconds) {
    send(pdu);
    bench_.run_for(std::chrono::microseconds(random() % most_microseconds));
  };
  unsigned updates = 0;
  for (unsigned cuts = 0; cuts < most && !HasFailure(); ++cuts) {
    const milliseconds time = cuts % 3 == 1 ? milliseconds(20'000) : milliseconds(random() % 1500);
    const nanoseconds fails = bench_.now() + time;
    const int version = read(0x00FE);
    const bool old = version == '1' || version == '0';
    ASSERT_TRUE(old || version == '3') << version;
    EXPECT_EQ(read(0x01E4), 5) << "the settings are lost";
    const Content& content = old ? new_ : old_;
    EXPECT_EQ(begin_update(content).size(), 5U);
    for (std::uint32_t offset = next(); offset < content.image.size() && bench_.now() < fails;
         offset += kBlockSize) {
      EXPECT_EQ(block(content, offset).size(), 5U) << offset;
    }
    if (read(kRegisterOfState) != static_cast<int>(State::Complete)) {
      send_and_run(block_pdu(content, next()), random() % 2 == 0 ? 60'000 : 1'000);
    } else if (random() % 4 == 0) {
      send_and_run(action_pdu(kActivate), 80'000);
    } else {
      EXPECT_EQ(act(kActivate).size(), 5U);
      bench_.run_for(milliseconds(100));
      restart();
      EXPECT_EQ(read(kRegisterOfState), static_cast<int>(State::Unconfirmed));
      if (random() % 4 == 0) {
        send_and_run(action_pdu(kConfirm), 4'000);
      } else {
        EXPECT_EQ(act(kConfirm).size(), 5U);
        ++updates;
      }
    }
    bench_.power(false);
    bench_.power(true);
    restart();
    if (read(kRegisterOfState) ==
        static_cast<int>(State::Unconfirmed)) {  // the power has failed before its start
      EXPECT_EQ(act(kConfirm).size(), 5U);
      ++updates;
    }
  }
  std::printf("%u cuts, %u updates\n", most, updates);
  EXPECT_GE(updates, most / 8);
}

/// Nothing of it comes into the slot, and the transfer goes on.
TEST_F(PicoUpdate, AWrongRequestIsRefused) {
  constexpr std::uint8_t kWrongValue = 3;
  constexpr std::uint8_t kRefused = 4;
  constexpr std::size_t kDataAt = 6;
  constexpr std::size_t kSome = 9;  // a place in the data of a block
  new_.image.resize(200);
  new_.seal(2);
  const auto with = [](Bytes pdu, std::size_t at, std::uint8_t changed_bits) {
    pdu[kDataAt + at] ^= changed_bits;
    return pdu;
  };
  Content other = new_;
  other.image[kSome] ^= 1U;
  const Bytes begin = begin_pdu(new_);
  const Bytes first = block_pdu(new_, 0);
  EXPECT_EQ(request(first), (Bytes{0x90, kWrongValue})) << "before a begin";
  ASSERT_EQ(begin_update(new_).size(), 5U);
  EXPECT_EQ(request(block_pdu(new_, kBlockSize)), (Bytes{0x90, kWrongValue})) << "before the first block";
  ASSERT_EQ(block(new_, 0).size(), 5U);
  const struct {
    const char* what;
    Bytes pdu;
    std::uint8_t exception;
  } kRequests[] = {
      {"other model", with(begin, 3, '2' ^ '3'), kRefused},
      {"other board", with(begin, 10, 'o' ^ 'w'), kRefused},
      {"no length", with(begin, update::kLengthAt + 3, 200), kRefused},
      {"longer than a slot", with(begin, update::kLengthAt + 1, 2), kRefused},
      {"unknown flag", with(begin, update::kFlagsAt + 1, 2), kRefused},
      {"reserved byte", with(begin, update::kReservedAt, 1), kRefused},
      {"flipped bit in the offset", with(first, 2, 1), kWrongValue},
      {"flipped bit in the bytes", with(first, kSome, 1), kWrongValue},
      {"flipped bit in the CRC", with(first, update::kBlockCheckAt, 1), kWrongValue},
      {"not at the beginning of a block", block_pdu(new_, 1), kWrongValue},
      {"beyond the image", block_pdu(new_, 2 * kBlockSize), kWrongValue},
      {"other bytes than before", block_pdu(other, 0), kWrongValue},
  };
  for (const auto& [what, pdu, exception] : kRequests) {
    EXPECT_EQ(request(pdu), (Bytes{0x90, exception})) << what;
    EXPECT_EQ(next(), kBlockSize) << what;
  }
  ASSERT_EQ(block(new_, kBlockSize).size(), 5U);
  EXPECT_EQ(read(kRegisterOfState), static_cast<int>(State::Complete));
  // A bit of the image, or of its CRC, is wrong.
  ASSERT_EQ(request(with(begin, update::kImageCheckAt, 1)).size(), 5U);
  ASSERT_EQ(block(new_, 0).size(), 5U);
  EXPECT_EQ(block(new_, kBlockSize), (Bytes{0x90, kRefused}));
  EXPECT_EQ(read(kRegisterOfState), static_cast<int>(State::None));
}

/// A complete image that does not work: the old one comes back, with its settings.
TEST_F(PicoUpdate, ABadImageIsTakenBack) {
  constexpr int kNoReply = -1;
  constexpr int kUnconfirmed = static_cast<int>(State::Unconfirmed);
  constexpr int kTakenBack = static_cast<int>(State::TakenBack);
  const auto in_place_of = [](unsigned exception, std::uint16_t instruction) {
    return [=](Content& content) { content.replace_first_instruction(exception, instruction); };
  };
  const auto later = [](std::uint16_t instruction) {
    return [=](Content& content) { after_30_s(content, instruction); };
  };
  // An image that fails before it has started its watchdog leaves Software, the reason of its own start.
  const struct {
    const char* what;
    std::function<void(Content&)> spoil;
    int state;           ///< at first
    milliseconds lives;  ///< so long, then it is reset
    ResetReason reason;
  } kImages[] = {
      {"hangs", in_place_of(kReset, kBranchToItself), kNoReply, {}, ResetReason::Software},
      {"faults", in_place_of(kReset, kUndefined), kTakenBack, {}, ResetReason::Software},
      {"hangs at a byte", in_place_of(kUart0, kBranchToItself), kNoReply, {}, ResetReason::ModuleWatchdog},
      {"faults at a byte", in_place_of(kUart0, kUndefined), kNoReply, {}, ResetReason::Fault},
      {"hangs after 30 s", later(kBranchToItself), kUnconfirmed, milliseconds(30'000),
       ResetReason::ModuleWatchdog},
      {"faults after 30 s", later(kUndefined), kUnconfirmed, milliseconds(30'000), ResetReason::Fault},
      {"answers nobody", hear_nothing, kNoReply, milliseconds(61'000), ResetReason::PowerOn},
  };
  for (const auto& image : kImages) {
    SCOPED_TRACE(image.what);
    Content bad = new_;
    image.spoil(bad);
    bad.seal(2);
    ASSERT_TRUE(send_all(bad));
    ASSERT_EQ(act(kActivate).size(), 5U);
    bench_.run_for(milliseconds(100));
    restart();
    EXPECT_EQ(read(kRegisterOfState), image.state);
    bench_.run_for(image.lives);
    if (image.reason == ResetReason::PowerOn) {
      EXPECT_EQ(read(kRegisterOfState), kNoReply);
      bench_.power(false);
      bench_.power(true);
    } else {
      bench_.run_for(kWatchdogPeriod);
    }
    restart();
    EXPECT_EQ(read(kRegisterOfState), kTakenBack);
    EXPECT_EQ(read(0x0301), static_cast<int>(image.reason));
    EXPECT_EQ(read(0x00FE), '0');
    EXPECT_EQ(read(0x01E4), 5);
  }
}

}  // namespace
}  // namespace ex9000::pico
