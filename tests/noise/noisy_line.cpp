#include "tests/noise/noisy_line.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "sim/play/modbus_frame.hpp"
#include "tests/noise/theory.hpp"
#include "tests/reference/dcon_check.hpp"

namespace ex9000::noise {

namespace {

using sim::VirtualTime;
using std::chrono::milliseconds;

constexpr std::size_t kModule = 1;
constexpr unsigned kOutputs = 13;
/// From a request's last byte to where its reply, of 9 characters or fewer, is over and another may come.
constexpr VirtualTime kReplies = milliseconds(6);
/// Longer than storing takes, or whatever else a frame may bring about.
constexpr VirtualTime kLongest = milliseconds(300);
/// No frame that is sent here is longer; one that noise has made may be, and is not looked for.
constexpr std::size_t kLongestFrame = 16;

std::string hex(unsigned value, unsigned digits) {
  constexpr char kDigits[] = "0123456789ABCDEF";
  std::string text;
  for (unsigned shift = 4 * digits; shift != 0; shift -= 4) {
    text += kDigits[value >> (shift - 4) & 0xFU];
  }
  return text;
}

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
  // A CRC cares for the frame's length alone.
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
      noise_(line_.bus(), {}, seed),
      random_(seed + 1),
      dcon_(check == Check::Sum) {
  line_.bus().attach(*this);
  line_.bus().observe(*this);
  line_.bus().disturb(*this);
  line_.module(0).output_pins().on_change([this](std::uint16_t /*channels*/) {
    if (watching_) {
      expect_reason("a change of outputs");
    }
  });
  line_.master().set_baud(kBaud);
  come_up();
}

void NoisyLine::come_up() {
  const bool watching = std::exchange(watching_, false);
  line_.module(0).power(false);
  line_.module(0).store(specs_[0].settings);
  line_.come_up();
  clear_witness();
  expected_outputs_ = 0;
  watching_ = watching;
}

FrameBytes NoisyLine::a_request() {
  const unsigned kind = below(3);
  // A few, for what theory expects is reckoned for each.
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
  line_.bus().run_for(takes);
  noise_.set_rates({});
  line_.bus().run_for(then);
}

void NoisyLine::exchange(const FrameBytes& request, double flipped_bit, Tally& tally) {
  clear_witness();
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
  const Heard heard = what_was_heard();
  ++tally.sent;
  tally.damaged += damaged ? 1U : 0U;
  if (in_framing == 0) {
    tally.expected += misses(check_, request, flipped_bit);
    tally.in_data += in_data != 0 ? 1U : 0U;
  }
  const bool taken = heard.finding != Finding::Nothing;
  if (taken && damaged) {
    ++(in_framing == 0 ? tally.taken_in_data : tally.taken_otherwise);
  }
  ASSERT_TRUE(damaged || heard.frame == request || check_ != Check::Crc)
      << "the witness heard something else";
  ASSERT_EQ(replies_, heard.finding == Finding::Request ? 1U : 0U) << "frames as received, and replies";

  const bool for_us = heard.finding == Finding::Request || heard.finding == Finding::Silent;
  const auto demands = for_us ? demanded(heard.frame) : expected_outputs_;
  if (demands) {
    expected_outputs_ = *demands;
    ASSERT_EQ(outputs(), expected_outputs_) << "the outputs and what was received";
    return;
  }
  // Whatever it was told, it was told; nothing else counts on what it is now.
  ++tally.surprises;
  line_.bus().run_for(kLongest);
  come_up();
}

std::optional<std::uint16_t> NoisyLine::demanded(const FrameBytes& frame) const {
  if (check_ == Check::Crc) {
    const unsigned function = frame[1];
    const auto word = [&](std::size_t at) { return static_cast<unsigned>(frame[at] * 256U + frame[at + 1]); };
    if (function == 1 || function == 2 || function == 3 || function == 4 || function > 0x7F) {
      return expected_outputs_;
    }
    if (function == 5 && frame.size() == 8 && word(2) < kOutputs && (word(4) == 0xFF00 || word(4) == 0)) {
      const auto bit = static_cast<std::uint16_t>(1U << word(2));
      return static_cast<std::uint16_t>(word(4) != 0 ? expected_outputs_ | bit : expected_outputs_ & ~bit);
    }
    if (function == 15 && frame.size() == 11 && word(2) == 0 && word(4) == kOutputs && frame[6] == 2) {
      return static_cast<std::uint16_t>((frame[8] * 256U + frame[7]) & 0x1FFFU);
    }
    return std::nullopt;
  }
  const std::string text(frame.begin(), frame.end());
  if (text == "@01" || text == "$016") {
    return expected_outputs_;
  }
  const bool four_digits =
      text.size() == 7 && text.find_first_not_of("0123456789ABCDEF", 3) == std::string::npos;
  if (text.substr(0, 3) == "@01" && four_digits && text[3] <= '1') {
    return static_cast<std::uint16_t>(std::stoul(text.substr(3), nullptr, 16));
  }
  return std::nullopt;
}

void NoisyLine::expect_the_first_clean_frame_is_answered() {
  noise_.set_rates({});
  line_.bus().run_for(kLongest);
  if (check_ != Check::Crc) {
    send({'\r'}, kLongest);
  }
  to_master_.clear();
  clear_witness();
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
  EXPECT_EQ(to_master_, reply) << name_of(check_) << ": the first clean frame";
}

sim::Levels NoisyLine::disturbed(const Sent& sent) {
  const sim::Levels levels = noise_.disturbed(sent);
  constexpr sim::Levels kStartAndStop = 0x201;
  const auto flipped = static_cast<sim::Levels>(levels ^ sent.levels);
  flips_in_framing_ += (flipped & kStartAndStop) != 0 ? 1U : 0U;
  flips_in_data_ += (flipped & ~kStartAndStop) != 0 ? 1U : 0U;
  return levels;
}

void NoisyLine::clear_witness() {
  bytes_.clear();
  good_.clear();
  dcon_heard_ = {};
  replies_ = 0;
}

NoisyLine::Heard NoisyLine::what_was_heard() {
  if (check_ != Check::Crc) {
    return dcon_heard_;
  }
  Heard heard;
  std::size_t from = 0;
  heard.finding = judge_rtu(bytes_, good_, &from);
  heard.frame.assign(bytes_.begin() + static_cast<std::ptrdiff_t>(from), bytes_.end());
  return heard;
}

void NoisyLine::receive(std::uint8_t byte, ByteStatus status) {
  if (module_drives_) {
    return;
  }
  const bool good = status == ByteStatus::Good;
  if (check_ == Check::Crc) {
    bytes_.push_back(byte);
    good_.push_back(good);
    if (watching_) {
      note_right_frame();
    }
    return;
  }
  const Finding finding = dcon_.feed(byte, good);
  if (finding == Finding::Nothing) {
    return;
  }
  dcon_heard_ = {finding, FrameBytes(dcon_.frame().begin(), dcon_.frame().end())};
  if (watching_ && finding != Finding::Foreign) {
    latest_right_frame_ = line_.clock().virtual_now();
    if (finding == Finding::Request) {
      right_frames_.push_back(latest_right_frame_);
    }
  }
}

/// Any of the latest bytes may have begun it: where frames end depends on times that are not asked here.
void NoisyLine::note_right_frame() {
  const std::size_t most = std::min(bytes_.size(), kLongestFrame);
  for (std::size_t size = 1; size <= most && good_[good_.size() - size]; ++size) {
    const std::size_t from = bytes_.size() - size;
    if (size < 4 || bytes_[from] > 1 || !crc_is_right(bytes_, from)) {
      continue;
    }
    latest_right_frame_ = line_.clock().virtual_now();
    if (meaning_of_rtu(bytes_, from) == Finding::Request) {
      right_frames_.push_back(latest_right_frame_);
    }
  }
}

void NoisyLine::expect_reason(const char* what) {
  ++reasons_;
  EXPECT_LT((line_.clock().virtual_now() - latest_right_frame_).count(), VirtualTime(kLongest).count())
      << name_of(check_) << ": " << what << " without a frame that is right, at "
      << line_.clock().virtual_now().count() << " ns";
}

void NoisyLine::driver(std::size_t station, bool on, VirtualTime now) {
  if (station != kModule) {
    return;
  }
  module_drives_ = on;
  if (!on) {
    if (watching_) {
      bytes_.clear();
      good_.clear();
    }
    dcon_.forget();
    return;
  }
  ++replies_;
  if (watching_) {
    expect_reason("a reply");
    while (!right_frames_.empty() && now - right_frames_.front() > kLongest) {
      right_frames_.pop_front();  // lost: two were waiting already
    }
    EXPECT_FALSE(right_frames_.empty()) << name_of(check_) << ": a second reply to one request";
    if (!right_frames_.empty()) {
      right_frames_.pop_front();
    }
  }
}

}  // namespace ex9000::noise
