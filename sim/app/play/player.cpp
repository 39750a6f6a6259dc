#include "sim/app/play/player.hpp"

#include <algorithm>
#include <array>
#include <stdexcept>

#include "sim/app/play/playing.hpp"
#include "sim/text/values.hpp"

namespace ex9000::play {

namespace {

constexpr std::chrono::milliseconds kLongestReply{250};
/// In this time, the first extra byte of a reply that is too long arrives, at 9600 baud or more.
constexpr std::chrono::milliseconds kAfterReply{2};
/// In this time after the request, an unexpected reply begins, without a store: longer than T3.5 at 1200
/// baud, the 20 ms within which a reply must begin, and its first character.
constexpr std::chrono::milliseconds kReplyBegins{65};

/// Without the firmware's code, so that the tests do not check the firmware with itself.
std::string checksum_of(const std::string& text) {
  unsigned sum = 0;
  for (const char character : text) {
    sum += static_cast<unsigned char>(character);
  }
  constexpr std::array<char, 17> kDigits{"0123456789ABCDEF"};
  return {kDigits[sum / 16 % 16], kDigits[sum % 16]};
}

/// As text if all is printable ASCII except a CR at the end, else in hex; without bytes, `nothing`.
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

}  // namespace

void Playing::send(const Bytes& request) {
  nothing_more();
  target_.send(request);
  reply_pending_ = true;
}

void Playing::send_more(const Bytes& bytes) {
  target_.send(bytes);
  reply_pending_ = true;
}

void Playing::expect_one_of(const std::vector<Bytes>& permitted) {
  const Bytes heard = target_.receive(permitted.front().size(), kLongestReply);
  reply_pending_ = false;
  if (std::find(permitted.begin(), permitted.end(), heard) == permitted.end()) {
    throw std::runtime_error("expected " + shown(permitted.front()) + ", received " + shown(heard));
  }
}

void Playing::expect_outputs(std::uint16_t channels) {
  const std::uint16_t outputs = target_.outputs();
  if (outputs != channels) {
    throw std::runtime_error("outputs are " + sim::hex_word_text(outputs));
  }
}

void Playing::expect_led(Led shows) {
  const Led shown = target_.led(shows);
  if (shown != shows) {
    throw std::runtime_error(std::string("the LED is ") + led_text(shown));
  }
}

void Playing::nothing_for(std::chrono::nanoseconds time) {
  const Bytes heard = target_.listen(time);
  reply_pending_ = reply_pending_ && time < kReplyBegins;
  if (!heard.empty()) {
    throw std::runtime_error("expected nothing, received " + shown(heard));
  }
}

void Playing::nothing_more() {
  if (!rehearses_) {
    nothing_for(reply_pending_ ? kReplyBegins : kAfterReply);
  }
}

Bytes Playing::dcon_frame(const std::string& text) const {
  const std::string frame = text + (checksum_ ? checksum_of(text) : "") + "\r";
  return {frame.begin(), frame.end()};
}

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
    who = " (" + transcript.run + ")";
  }
  Playing playing(target, checksum);
  try {
    for (const Step& step : transcript.steps) {
      ++result.steps;
      where = transcript.file + ":" + std::to_string(step.line) + ": " + step.text;
      step.run(playing);
    }
    where = transcript.file + ": at the end";
    playing.nothing_more();
    target.end();
  } catch (const std::exception& error) {
    result.failure = where + ": " + error.what() + who;
  }
  return result;
}

}  // namespace ex9000::play
