#include "tests/oracles/reference/session.hpp"

#include <algorithm>
#include <utility>

#include "sim/notation/module_notation.hpp"
#include "tests/oracles/reference/dcon_check.hpp"
#include "tests/oracles/reference/hexadecimal.hpp"
#include "tests/oracles/reference/modbus_check.hpp"

namespace ex9000::reference {

namespace {

using std::chrono::milliseconds;

/// The session sends nothing and compares nothing within this time before or after a moment at which the
/// module changes by itself. This time covers one tick, and the time until the module executes a received
/// request.
constexpr milliseconds kMargin{3};
/// Longer than the time that the module requires to store a command (wire.md 3), or to store the timeout
/// status and the enable flag after an expiry (wire.md 6).
constexpr milliseconds kStored{250};
/// wire.md 3: the reply to a request that stores nothing starts within 20 ms.
constexpr milliseconds kAnswers{20};
constexpr milliseconds kAnswersStoring{200};
/// If a request stores nothing and nothing else is being stored, its reply begins within this time after the
/// request, at any baud rate. The player of transcripts (sim/app/play/player.cpp) waits for the same time, so
/// that a transcript has the same timing in the player.
constexpr milliseconds kNoAnswer{65};
/// The time for which the session listens for extra bytes, for example before a reset. If a reply is too
/// long, its first extra byte arrives in this time, at 9600 baud or more.
constexpr milliseconds kBetween{2};
/// Longer than the debounce time of INIT* (wire.md 2).
constexpr milliseconds kDebounced{100};

std::string text_of(const Bytes& bytes) { return std::string(bytes.begin(), bytes.end()); }

bool printable(const std::string& text) {
  return std::all_of(text.begin(), text.end(),
                     [](char character) { return character >= 0x20 && character <= 0x7E; });
}

/// Returns whether the text can be the text of a request in a transcript. There, two blanks and `;` begin a
/// comment, and braces enclose a variable.
bool can_be_written(const std::string& text) {
  return printable(text) && text.find("  ;") == std::string::npos && text.find('{') == std::string::npos;
}

std::string hex_of(const Bytes& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += (text.empty() ? "" : " ") + hex(byte, 2);
  }
  return text;
}

}  // namespace

Session::Session(const ModelRow& row, Extensions extensions) : reference_(row, extensions) {
  target_.start(sim::model_called(row.designation), nullptr);
  reference_.power(true, target_.now() - kComingUp);
  lines_.emplace_back("source: a random session");
  lines_.push_back(std::string("model: ") + row.designation);
  lines_.emplace_back();
}

std::vector<std::string> Session::rules() const {
  std::vector<std::string> rules = rules_;
  for (const std::string& rule : reference_.rules()) {
    rules.push_back(rule);
  }
  return rules;
}

std::string Session::transcript() const {
  std::string text;
  for (const std::string& line : lines_) {
    text += line + "\n";
  }
  return text;
}

bool Session::play(const Step& step) {
  // `play_step` copies the reference together with its rules. Therefore the rules of earlier steps are moved
  // to `rules_` first.
  for (std::string& rule : reference_.take_rules()) {
    rules_.push_back(std::move(rule));
  }
  if (!std::holds_alternative<Send>(step) && !stored()) {
    return false;
  }
  return std::visit([this](const auto& one) { return play_step(one); }, step) && settle(Time(0)) && compare();
}

/// Waits until nothing is being stored.
bool Session::stored() {
  const bool storing = std::exchange(storing_, false);
  return !(storing || target_.now() < timeout_stored_) || listen(kStored);
}

/// Sets the master to the baud rate, line format and checksum of the reference.
bool Session::follow() {
  if (reference_.rate() != rate_) {
    if (!nothing_more()) {
      return false;
    }
    rate_ = reference_.rate();
    lines_.push_back("baud " + std::to_string(rate_));
    target_.set_baud(rate_);
  }
  if (reference_.format() != format_) {
    format_ = reference_.format();
    set_format(format_);
  }
  if (reference_.checksum() != checksum_) {
    checksum_ = reference_.checksum();
    lines_.emplace_back(checksum_ ? "checksum on" : "checksum off");
  }
  return true;
}

/// Sets the line format of the master. This takes no time.
void Session::set_format(LineFormat format) {
  lines_.push_back(std::string("format ") + name_of(format));
  target_.set_format(format);
}

/// Listens for a short time and checks that the module sends nothing. The transcript contains no line for
/// this time.
bool Session::nothing_more() {
  const play::Bytes heard = target_.listen(kBetween);
  return heard.empty() || differs("; nothing more", reply_line(heard));
}

/// Returns whether the module might change by itself within `needed`.
bool Session::changes_within(Time needed) {
  const std::vector<Module::Moment> moments = reference_.moments();
  return std::any_of(moments.begin(), moments.end(), [&](const Module::Moment& moment) {
    return target_.now() + needed > moment.earliest - kMargin;
  });
}

/// If the module might change by itself within `needed`, lets time pass until it has changed.
bool Session::settle(Time needed) {
  while (changes_within(needed)) {
    if (!listen(std::chrono::duration_cast<milliseconds>(needed) + milliseconds(1))) {
      return false;
    }
  }
  return true;
}

/// Listens for `time`, or longer if the module might change by itself at the end of `time`.
bool Session::listen(milliseconds time) {
  const Time now = target_.now();
  const bool might_expire = reference_.expiry().has_value();
  const Time expired = might_expire ? reference_.expiry()->latest + kMargin : Time(0);
  const std::vector<Module::Moment> moments = reference_.moments();
  for (bool changes = true; changes;) {
    changes = false;
    for (const Module::Moment& moment : moments) {
      const Time over = moment.latest + kMargin;
      if (now + time > moment.earliest - kMargin && now + time < over) {
        time = std::chrono::duration_cast<milliseconds>(over - now) + milliseconds(1);
        changes = true;
      }
    }
  }
  lines_.push_back("wait " + std::to_string(time.count()) + "ms");
  const play::Bytes heard = target_.listen(time);
  reference_.pass(target_.now());
  // At a timeout, the outputs and the timeout status change immediately. The next request may arrive while
  // the timeout is being stored.
  storing_timeout_ = false;
  if (might_expire && !reference_.expiry()) {
    timeout_stored_ = expired + kStored;
    storing_timeout_ = target_.now() < timeout_stored_;
  }
  return heard.empty() || differs("; silence", reply_line(heard));
}

/// Adds the difference to the transcript and returns false. `expected`: the next step of the transcript, or a
/// comment if no kind of step can express the expectation.
bool Session::differs(const std::string& expected, const std::string& got) {
  lines_.push_back(expected);
  lines_.push_back("; the firmware differs: " + got);
  return false;
}

bool Session::compare() {
  if (storing_) {
    return true;  // wire.md 8: a command takes effect when it is stored
  }
  const unsigned outputs = target_.outputs();
  if (outputs != reference_.outputs()) {
    return differs("outputs " + hex(reference_.outputs(), 4), "outputs " + hex(outputs, 4));
  }
  using play::Led;
  const Led expected = !reference_.powered() ? Led::Off : reference_.led_flashes() ? Led::Flashing : Led::On;
  const Led led = target_.led(expected);
  const char* const names[] = {"led on", "led off", "led flashing"};
  return led == expected ||
         differs(names[static_cast<unsigned>(expected)], names[static_cast<unsigned>(led)]);
}

/// Returns the time that bytes take on the line.
Time Session::takes(std::size_t bytes, LineFormat format) const {
  return Time(bytes * character_bits(format) * 1'000'000'000ULL / rate_);
}

/// Returns the time from the first start bit of a reply to the end of the first stop bit of its last byte. At
/// the end of this time, the master has received the reply.
Time Session::heard_in(std::size_t bytes) const {
  const unsigned second_stop_bit = format_ == LineFormat::k8N2 ? 1 : 0;
  return Time((bytes * character_bits(format_) - second_stop_bit) * 1'000'000'000ULL / rate_);
}

bool Session::play_step(const Send& send) {
  // wire.md 7: a silence of 3.5 characters of 11 bits, or of 1.75 ms above 19200 baud, ends a Modbus frame.
  // The reply starts no earlier than the end of this silence.
  const Time modbus_silence = rate_ <= 19200 ? Time(77ULL * 1'000'000'000ULL / (2ULL * rate_))
                                             : Time(std::chrono::microseconds(1750));
  const Time turn_around = reference_.runs_modbus() ? modbus_silence : takes(1);
  // A reply must start within 20 ms or 200 ms. If the response delay is longer than the turn-around, this
  // time begins at the end of the delay.
  const Time delay = reference_.reply_delay() > turn_around ? reference_.reply_delay() : Time(0);
  const Time earliest = std::max(turn_around, delay);
  // wire.md 7 allows 20 ms from the end of a Modbus frame, which is the end of its silence. If the response
  // delay is not longer than the turn-around, the session allows less time: 20 ms after the last byte, or
  // 5 ms after the silence if that is later.
  const Time answers = std::max<Time>(kAnswers + delay, turn_around + milliseconds(5));

  Answer answer;
  while (true) {
    Module trial = reference_;
    answer = trial.on_request(send.bytes, target_.now() + takes(send.bytes.size()));
    if (answer.left_open != nullptr) {
      ++left_open_;
      return true;
    }
    const Time done = answer.stores ? answers + kStored : answer.reply.empty() ? Time(kNoAnswer) : answers;
    const Time waits = storing_ || storing_timeout_ ? kAnswersStoring : milliseconds(0);
    const Time needed = waits + takes(send.bytes.size() + answer.reply.size()) + done + kBetween;
    // The loop repeats because the reply may depend on whether the module has changed.
    if (!changes_within(needed)) {
      break;
    }
    if (!settle(needed)) {
      return false;
    }
  }

  // The player of transcripts sends a `bytes` line immediately. Before any other request it checks that no
  // more bytes arrive.
  behind_expiry_ += storing_timeout_ ? 1U : 0U;
  const bool behind_another = std::exchange(storing_, false) || storing_timeout_;
  storing_timeout_ = false;
  const std::string line = behind_another ? "bytes " + hex_of(send.bytes) : sent_line(send.bytes);
  const bool at_once = line.rfind("bytes", 0) == 0;
  if (!behind_another && !(at_once ? listen(kBetween) : nothing_more())) {
    return false;
  }
  lines_.push_back(line);
  target_.send(send.bytes);
  const Time sent = target_.now();
  before_expiry_ += reference_.expiry() && reference_.expiry()->earliest - sent < milliseconds(100) ? 1U : 0U;
  answer = reference_.on_request(send.bytes, sent);
  ++transactions_;
  if (answer.reply.empty()) {
    // wire.md 8: while one command is being stored, the module keeps at least one more frame.
    storing_ = send.next_may_follow_at_once && answer.stores && reference_.runs_modbus() && !behind_another;
    if (storing_) {
      return listen(std::chrono::duration_cast<milliseconds>(modbus_silence) + milliseconds(2));
    }
    return listen(answer.stores || behind_another ? kStored : kNoAnswer);
  }
  const play::Bytes heard = target_.receive(answer.reply.size(), behind_another ? 2 * kStored : kStored);
  if (heard != answer.reply) {
    return differs(reply_line(answer.reply), reply_line(heard));
  }
  lines_.push_back(reply_line(answer.reply));
  const Time began = target_.now() - heard_in(heard.size());
  reference_.replied(began);
  const auto microseconds = [](Time time) {
    return std::to_string(std::chrono::duration_cast<std::chrono::microseconds>(time).count()) + " us";
  };
  const Time latest = (answer.stores ? std::max<Time>(kAnswersStoring + delay, answers) : answers) +
                      (behind_another ? kAnswersStoring : milliseconds(0));
  const Time after = began - sent;
  if (after < earliest - std::chrono::microseconds(2) || after > latest) {
    return differs("; a reply after " + microseconds(earliest) + " to " + microseconds(latest),
                   "after " + microseconds(after));
  }
  return true;
}

bool Session::play_step(const SendInAnotherFormat& send) {
  if (!settle(takes(send.bytes.size(), send.format) + kNoAnswer + kStored + kBetween)) {
    return false;
  }
  Module trial = reference_;
  const Answer answer = trial.on_bytes(send.bytes, send.format,
                                       target_.now() + kBetween + takes(send.bytes.size(), send.format));
  if (answer.left_open != nullptr || !answer.reply.empty()) {
    ++left_open_;  // the reference cannot predict the reply, or the master could not read it
    return true;
  }
  if (!listen(kBetween)) {
    return false;
  }
  set_format(send.format);
  lines_.push_back("bytes " + hex_of(send.bytes));
  target_.send(send.bytes);
  set_format(format_);
  const bool stores = reference_.on_bytes(send.bytes, send.format, target_.now()).stores;
  return listen(stores ? kStored : kNoAnswer);
}

bool Session::play_step(const Wait& wait) { return listen(wait.time); }

bool Session::play_step(const WaitForExpiry& wait) {
  if (!reference_.expiry()) {
    return true;
  }
  const Time time = reference_.expiry()->earliest - wait.before - target_.now();
  return time < milliseconds(1) || listen(std::chrono::duration_cast<milliseconds>(time));
}

bool Session::play_step(const Reset& /*reset*/) {
  if (!reference_.powered()) {
    return true;  // the simulator rejects it
  }
  if (!settle(kComingUp + 2 * kBetween) || !stored()) {
    return false;
  }
  if (!nothing_more()) {
    return false;
  }
  lines_.emplace_back("reset");
  const Time began = target_.now();
  target_.reset();
  reference_.reset(began);
  return follow();
}

bool Session::play_step(const Power& power) {
  if (!settle(kComingUp + 2 * kBetween) || !stored()) {
    return false;
  }
  if (power.on == reference_.powered()) {
    return true;
  }
  if (!nothing_more()) {
    return false;
  }
  lines_.emplace_back(power.on ? "power on" : "power off");
  const Time began = target_.now();
  target_.power(power.on);
  reference_.power(power.on, began);
  return follow();
}

bool Session::play_step(const Init& init) {
  lines_.emplace_back(init.asserted ? "init on" : "init off");
  target_.set_init(init.asserted);
  reference_.set_init(init.asserted);
  return listen(kDebounced);
}

/// Returns the beginning of a line about an input. A transcript cannot set inputs that its model does not
/// have, so a line about such an input becomes a comment.
std::string Session::lacking(unsigned channel) const { return channel < reference_.row().inputs ? "" : "; "; }

bool Session::play_step(const Input& input) {
  lines_.push_back(lacking(input.channel) + "input " + std::to_string(input.channel) +
                   (input.level ? " on" : " off"));
  target_.module().set_input(input.channel, input.level);
  reference_.set_input(input.channel, input.level, target_.now());
  return true;
}

bool Session::play_step(const Pulse& pulse) {
  lines_.push_back(lacking(pulse.channel) + "pulse " + std::to_string(pulse.channel) + " x" +
                   std::to_string(pulse.count));
  target_.module().pulse_input(pulse.channel, pulse.count);
  reference_.pulse_input(pulse.channel, pulse.count, target_.now());
  return true;
}

std::string Session::sent_line(const Bytes& bytes) const {
  if (reference_.runs_modbus()) {
    return crc_is_right(bytes) ? "=> " + hex_of(Bytes(bytes.begin(), bytes.end() - 2))
                               : "bytes " + hex_of(bytes);
  }
  const std::string text = text_of(bytes);
  const std::size_t behind = checksum_ ? 3 : 1;  // CR, and CHK before it if the checksum is enabled
  if (text.size() > behind && text.back() == '\r') {
    const std::string frame = text.substr(0, text.size() - behind);
    if (can_be_written(frame) && frame.front() != ' ' && frame.back() != ' ' &&
        (!checksum_ || text.substr(frame.size(), 2) == check_of(frame))) {
      return "> " + frame;
    }
  }
  return "bytes " + hex_of(bytes);
}

std::string Session::reply_line(const Bytes& bytes) const {
  if (bytes.empty()) {
    return "silence";
  }
  if (bytes.back() == '\r') {
    std::string text = text_of(bytes);
    text.pop_back();
    if (printable(text)) {
      return "< " + (checksum_ && text.size() > 2 ? text.substr(0, text.size() - 2) : text);
    }
  }
  return crc_is_right(bytes) ? "<= " + hex_of(Bytes(bytes.begin(), bytes.end() - 2))
                             : "bytes " + hex_of(bytes);
}

// --- shrinking ---

namespace {

bool makes_a_difference(const ModelRow& row, const std::vector<Step>& steps, Extensions extensions) {
  Session session(row, extensions);
  return !std::all_of(steps.begin(), steps.end(), [&](const Step& step) { return session.play(step); });
}

}  // namespace

std::vector<Step> shrink(const ModelRow& row, std::vector<Step> steps, Extensions extensions) {
  for (std::size_t size = steps.size() / 2; size != 0; size /= 2) {
    for (std::size_t at = 0; at + size <= steps.size();) {
      std::vector<Step> fewer = steps;
      const auto from = fewer.begin() + static_cast<std::ptrdiff_t>(at);
      fewer.erase(from, from + static_cast<std::ptrdiff_t>(size));
      if (makes_a_difference(row, fewer, extensions)) {
        steps = std::move(fewer);
      } else {
        at += size;
      }
    }
  }
  return steps;
}

std::string transcript_of(const ModelRow& row, const std::vector<Step>& steps, Extensions extensions) {
  Session session(row, extensions);
  std::all_of(steps.begin(), steps.end(), [&](const Step& step) { return session.play(step); });
  return session.transcript();
}

}  // namespace ex9000::reference
