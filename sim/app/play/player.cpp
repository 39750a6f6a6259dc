#include "sim/app/play/player.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "sim/app/play/modbus_frame.hpp"
#include "sim/text/values.hpp"

namespace ex9000::play {

namespace {

constexpr std::chrono::milliseconds kLongestReply{250};
/// If a reply is too long, its first extra byte arrives within this time, at 9600 baud or more.
constexpr std::chrono::milliseconds kAfterReply{2};
/// Without a store, an unexpected reply begins within this time after the request. The time is longer than
/// the sum of T3.5 at 1200 baud, the 20 ms within which a reply must begin, and the first character of the
/// reply.
constexpr std::chrono::milliseconds kReplyBegins{65};

/// Returns the DCON checksum of `text`. Does not use the firmware's code, so that the tests do not check the
/// firmware with its own code.
std::string checksum_of(const std::string& text) {
  unsigned sum = 0;
  for (const char character : text) {
    sum += static_cast<unsigned char>(character);
  }
  constexpr std::array<char, 17> kDigits{"0123456789ABCDEF"};
  return {kDigits[sum / 16 % 16], kDigits[sum % 16]};
}

/// Returns the bytes as text if all are printable ASCII, except a CR at the end; otherwise in hex. Returns
/// the word `nothing` if there are no bytes.
std::string shown(const Bytes& bytes) {
  if (bytes.empty()) {
    return "nothing";
  }
  const bool ends_with_cr = bytes.back() == '\r';
  const auto end = bytes.end() - (ends_with_cr ? 1 : 0);
  if (std::all_of(bytes.begin(), end, [](std::uint8_t byte) { return byte >= 0x20 && byte < 0x7F; })) {
    return "'" + std::string(bytes.begin(), end) + (ends_with_cr ? "\\r'" : "'");
  }
  return sim::hex_text(bytes, " ") + " (" + std::to_string(bytes.size()) + " bytes)";
}

const char* name_of(step::Led::Shows shows) {
  return shows == step::Led::Shows::On ? "on" : shows == step::Led::Shows::Off ? "off" : "flashing";
}

/// Each call carries out one step. Throws std::runtime_error if the step fails.
class Playing {
 public:
  Playing(Target& target, bool checksum) : target_(target), checksum_(checksum) {}

  void operator()(const step::SendDcon& step) { send(dcon_frame(step.text)); }
  void operator()(const step::ExpectDcon& step) { expect_one_of({dcon_frame(step.text)}); }
  void operator()(const step::SendModbus& step) { send(with_crc(step.frame)); }
  void operator()(const step::ExpectModbus& step) {
    std::vector<Bytes> permitted;
    for (const Bytes& frame : step.frames) {
      permitted.push_back(with_crc(frame));
    }
    expect_one_of(permitted);
  }
  /// Does not check for earlier replies, because the bytes may be the rest of a frame.
  void operator()(const step::SendBytes& step) {
    target_.send(step.bytes);
    reply_pending_ = true;
  }
  void operator()(const step::Silence& /*step*/) { nothing_for(kSilence); }
  void operator()(const step::Wait& step) { nothing_for(step.time); }
  void operator()(const step::Checksum& step) { checksum_ = step.on; }
  void operator()(const step::Format& step) { target_.set_format(step.format); }
  void operator()(const step::Baud& step) {
    nothing_more();
    target_.set_baud(step.rate);
  }
  void operator()(const step::Power& step) {
    nothing_more();
    target_.power(step.on);
  }
  void operator()(const step::PowerCycle& /*step*/) {
    nothing_more();
    target_.power(false);
    target_.power(true);
  }
  void operator()(const step::Reset& /*step*/) {
    nothing_more();
    target_.reset();
  }
  void operator()(const step::Init& step) { target_.set_init(step.asserted); }
  void operator()(const step::Input& step) { target_.set_input(step.channel, step.level); }
  void operator()(const step::Pulse& step) { target_.pulse_input(step.channel, step.count); }
  void operator()(const step::Outputs& step) {
    const std::uint16_t outputs = target_.outputs();
    if (outputs != step.channels) {
      throw std::runtime_error("outputs are " + sim::hex_word_text(outputs));
    }
  }
  void operator()(const step::Led& step) {
    const step::Led::Shows shows = target_.led(step.shows);
    if (shows != step.shows) {
      throw std::runtime_error(std::string("the LED is ") + name_of(shows));
    }
  }

  void operator()(const step::OnModule& step) {
    nothing_more();
    target_.choose_module(step.position);
  }
  void operator()(const step::OnLine& step) {
    nothing_more();
    target_.choose_line(step.name);
  }
  void operator()(const step::FaultCommand& step) { target_.run_fault_command(step.command); }

  /// Throws std::runtime_error if bytes arrive that no step expects.
  void nothing_more() { nothing_for(reply_pending_ ? kReplyBegins : kAfterReply); }

 private:
  [[nodiscard]] Bytes dcon_frame(const std::string& text) const {
    const std::string frame = text + (checksum_ ? checksum_of(text) : "") + "\r";
    return {frame.begin(), frame.end()};
  }

  void send(const Bytes& bytes) {
    nothing_more();
    target_.send(bytes);
    reply_pending_ = true;
  }

  /// `permitted` contains at least one reply; all have the same length.
  void expect_one_of(const std::vector<Bytes>& permitted) {
    const Bytes heard = target_.receive(permitted.front().size(), kLongestReply);
    reply_pending_ = false;
    if (std::find(permitted.begin(), permitted.end(), heard) == permitted.end()) {
      throw std::runtime_error("expected " + shown(permitted.front()) + ", received " + shown(heard));
    }
  }

  void nothing_for(std::chrono::nanoseconds time) {
    const Bytes heard = target_.listen(time);
    reply_pending_ = reply_pending_ && time < kReplyBegins;
    if (!heard.empty()) {
      throw std::runtime_error("expected nothing, received " + shown(heard));
    }
  }

  Target& target_;
  bool checksum_;
  bool reply_pending_ = false;  ///< bytes were sent, and a reply may still arrive
};

}  // namespace

Result play(const Transcript& transcript, Target& target) {
  Result result;
  std::string where = transcript.file;
  std::string who;
  bool checksum = false;
  if (transcript.model != nullptr) {
    target.start(*transcript.model, transcript.preset_given ? &transcript.preset : nullptr);
    target.set_baud(baud_rate(transcript.preset.baud_code));
    target.set_format(line_format(transcript.preset.baud_code));
    checksum = (transcript.preset.format & kFormatChecksum) != 0;
    who = " (" + std::string(transcript.model->designation) + ")";
  }
  Playing playing(target, checksum);
  try {
    for (const Step& step : transcript.steps) {
      ++result.steps;
      where = transcript.file + ":" + std::to_string(step.line) + ": " + step.text;
      std::visit(playing, step.action);
    }
    where = transcript.file + ": at the end";
    playing.nothing_more();
    target.end();
  } catch (const std::runtime_error& error) {
    result.failure = where + ": " + error.what() + who;
  }
  return result;
}

}  // namespace ex9000::play
