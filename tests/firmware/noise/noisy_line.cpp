#include "tests/firmware/noise/noisy_line.hpp"

#include <gtest/gtest.h>

#include <map>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/notation/module_notation.hpp"
#include "tests/firmware/noise/theory.hpp"
#include "tests/oracles/reference/dcon_check.hpp"
#include "tests/oracles/reference/hexadecimal.hpp"

namespace ex9000::noise {

namespace {

using reference::hex;
using sim::VirtualTime;
using std::chrono::milliseconds;

constexpr std::size_t kModule = 1;
constexpr unsigned kOutputs = 13;
/// The time that the master waits after a request. It is long enough for a reply of at most 10 characters.
constexpr VirtualTime kReplies = milliseconds(6);
/// Longer than the module needs to store the settings of a command and to reply.
constexpr VirtualTime kLongest = milliseconds(300);
std::string spec_of(Check check) {
  const std::string spec = "EX9042D-M@01,baud=115200";
  switch (check) {
    case Check::Crc:
      return spec + ",protocol=modbus";
    case Check::Sum:
      return spec + ",protocol=ascii,checksum=on";
    case Check::None:
      break;
  }
  return spec + ",protocol=ascii";
}

double misses(Check check, const FrameBytes& request, double flipped_bit) {
  static std::map<std::pair<FrameBytes, double>, double> known;
  // For the CRC, the result depends on the length of the frame, but not on its bytes.
  const FrameBytes key = check == Check::Crc ? FrameBytes(request.size()) : request;
  const auto [place, fresh] = known.try_emplace({key, flipped_bit});
  if (fresh) {
    place->second = check == Check::Crc
                        ? crc_misses(request.size(), flipped_bit)
                        : dcon_misses({request.begin(), request.end() - 1}, check == Check::Sum, flipped_bit);
  }
  return place->second;
}

}  // namespace

const char* name_of(Check check) {
  constexpr const char* kNames[] = {"Modbus RTU, CRC-16", "DCON, 8-bit sum", "DCON, no checksum"};
  return kNames[static_cast<unsigned>(check)];
}

NoisyLine::NoisyLine(Check check, std::uint64_t seed)
    : check_(check),
      specs_{sim::parse_module_spec(spec_of(check))},
      line_(specs_, sim::kPaced, [this](std::uint8_t byte, ByteStatus) { to_master_.push_back(byte); }),
      noise_(line_.wires(), {}, seed),
      random_(seed + 1),
      onlooker_(line_.wires(), line_.module(0), kModule) {
  line_.wires().attach(*this).listen({kBaud});
  line_.wires().disturb(*this);
  line_.master().set_baud(kBaud);
  come_up();
}

void NoisyLine::come_up() {
  onlooker_.stop_checking();
  line_.module(0).power(false);
  line_.module(0).store(specs_[0].settings);
  line_.come_up();
  onlooker_.start_checking();
}

FrameBytes NoisyLine::a_request() {
  const unsigned kind = below(3);
  // There are only a few values because in DCON `misses` computes a separate result for each request.
  constexpr std::uint16_t kOutputValues[] = {0x0000, 0x1FFF, 0x0A5A, 0x15A5};
  const std::uint16_t data = kOutputValues[below(4)];
  if (check_ == Check::Crc) {
    switch (kind) {
      case 0:
        return with_crc({1, 5, 0, static_cast<std::uint8_t>(below(kOutputs)),
                         static_cast<std::uint8_t>(below(2) == 0 ? 0xFF : 0x00), 0});
      case 1:
        return with_crc({1, 15, 0, 0, 0, kOutputs, 2, static_cast<std::uint8_t>(data & 0xFFU),
                         static_cast<std::uint8_t>(data >> 8U)});
      default:
        return with_crc({1, 1, 0, 0, 0, kOutputs});
    }
  }
  std::string text = kind == 0 ? "@01" : kind == 1 ? "$016" : "@01" + hex(data, 4);
  if (check_ == Check::Sum) {
    text += reference::check_of(text);
  }
  text += '\r';
  return {text.begin(), text.end()};
}

void NoisyLine::send(const FrameBytes& bytes, VirtualTime then) {
  const VirtualTime takes = line_.master().takes(bytes.size());
  line_.master().send(bytes.data(), bytes.size());
  line_.wires().run_for(takes);
  noise_.set_rates({});
  line_.wires().run_for(then);
}

void NoisyLine::exchange(const FrameBytes& request, double flipped_bit, Tally& tally) {
  const judges::Witness::Counts before = onlooker_.counts();
  const std::uint64_t replies_before = onlooker_.replies();
  flips_in_data_ = flips_in_framing_ = 0;
  sim::NoiseRates rates;
  rates.flipped_bit = flipped_bit;
  noise_.set_rates(rates);
  send(request, kReplies);
  const unsigned in_data = flips_in_data_;
  const unsigned in_framing = flips_in_framing_;
  if (check_ != Check::Crc) {
    send({'\r'}, kReplies);
  }

  const bool damaged = in_data + in_framing != 0;
  const judges::Witness::Counts& after = onlooker_.counts();
  const std::uint64_t requests = after.requests - before.requests;
  const bool taken = requests != 0 || after.silent != before.silent || after.foreign != before.foreign;
  ++tally.sent;
  tally.damaged += damaged ? 1U : 0U;
  if (in_framing == 0) {
    tally.expected += misses(check_, request, flipped_bit);
    tally.in_data += in_data != 0 ? 1U : 0U;
  }
  if (taken && damaged) {
    ++(in_framing == 0 ? tally.taken_in_data : tally.taken_otherwise);
  }
  ASSERT_TRUE(damaged || requests == 1) << "the witness did not receive exactly one request";
  ASSERT_EQ(onlooker_.replies() - replies_before, requests)
      << "the number of replies differs from the number of requests that require a reply";
  if (after.storing != before.storing) {
    // The command may have changed the stored settings. Later requests must not depend on the new values.
    ++tally.storing;
    line_.wires().run_for(kLongest);
    come_up();
  }
}

void NoisyLine::expect_the_first_clean_frame_is_answered() {
  noise_.set_rates({});
  line_.wires().run_for(kLongest);
  if (check_ != Check::Crc) {
    send({'\r'}, kLongest);
  }
  to_master_.clear();
  FrameBytes request;
  FrameBytes reply;
  const unsigned now = outputs();
  if (check_ == Check::Crc) {
    request = with_crc({1, 1, 0, 0, 0, kOutputs});
    reply = with_crc({1, 1, 2, static_cast<std::uint8_t>(now & 0xFFU), static_cast<std::uint8_t>(now >> 8U)});
  } else {
    const std::string asked = "@01";
    const std::string answer = ">" + hex(now, 4);
    const bool sums = check_ == Check::Sum;
    for (const auto& [text, bytes] : {std::pair(asked, &request), std::pair(answer, &reply)}) {
      const std::string whole = text + (sums ? reference::check_of(text) : "") + "\r";
      bytes->assign(whole.begin(), whole.end());
    }
  }
  send(request, kReplies);
  EXPECT_EQ(to_master_, reply) << name_of(check_) << ": wrong reply to the first request after the noise";
}

sim::Levels NoisyLine::disturbed(const Sent& sent) {
  const sim::Levels levels = noise_.disturbed(sent);
  constexpr sim::Levels kStartAndStop = 0x201;
  const auto flipped = static_cast<sim::Levels>(levels ^ sent.levels);
  flips_in_framing_ += (flipped & kStartAndStop) != 0 ? 1U : 0U;
  flips_in_data_ += (flipped & ~kStartAndStop) != 0 ? 1U : 0U;
  return levels;
}

void NoisyLine::receive(std::uint8_t byte, ByteStatus status) { onlooker_.hears(byte, status); }

}  // namespace ex9000::noise
