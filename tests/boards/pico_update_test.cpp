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

  Bytes begin_update(const Content& content) {
    Bytes pdu{0x10, 0x10, 0x00, 0, 16, 32};
    const update::Info info = content.slot().info;
    pdu.insert(pdu.end(), info.bytes.begin(), info.bytes.end());
    return request(pdu, milliseconds(400));
  }
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

/// What is wrong with an image, and the state in which the module is at last, with the old image.
TEST_F(PicoUpdate, ABadImageIsTakenBack) {
  constexpr std::size_t kResetHandler = 4;
  const std::uint16_t handler =
      ex9000::Bytes{new_.image.data(), new_.image.size()}.low_byte_first_16(kResetHandler);
  const std::vector<std::pair<const char*, std::uint16_t>> kInstructions{{"hang", 0xE7FE}, {"fault", 0xDE00}};
  for (const auto& [what, instruction] : kInstructions) {
    SCOPED_TRACE(what);
    Content bad = new_;
    bad.image[handler - 1U] = static_cast<std::uint8_t>(instruction);
    bad.image[handler] = static_cast<std::uint8_t>(instruction >> 8U);
    bad.seal(2);
    ASSERT_TRUE(send_all(bad));
    ASSERT_EQ(act(kActivate).size(), 5U);
    bench_.run_for(milliseconds(100) + kWatchdogPeriod);
    restart();
    EXPECT_EQ(read(kRegisterOfState), static_cast<int>(State::TakenBack));
    EXPECT_EQ(read(0x00FE), '0');
    EXPECT_EQ(read(0x01E4), 5);
  }
}

}  // namespace
}  // namespace ex9000::pico
