#include "sim/notation/input_notation.hpp"

#include <map>
#include <optional>

#include "sim/notation/word_reader.hpp"
#include "sim/text/durations.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

constexpr VirtualTime kShortest = std::chrono::microseconds(10);

using Times = std::map<std::string, VirtualTime>;

/// `forms`: the keywords that may appear.
void read_time(WordReader& words, const std::string& forms, Times& times) {
  const std::string keyword = words.next(forms);
  if (forms.find("'" + keyword + " TIME'") == std::string::npos) {
    fail("'" + keyword + "': expected " + forms);
  }
  if (!times.emplace(keyword, parse_time(words.next("a duration after '" + keyword + "'"))).second) {
    fail("'" + keyword + "' is given twice; leave out one of them");
  }
}

Times read_times(WordReader& words, const std::string& forms) {
  Times times;
  while (!words.done()) {
    read_time(words, forms, times);
  }
  return times;
}

VirtualTime time_of(const Times& times, const std::string& keyword, VirtualTime otherwise = VirtualTime(0)) {
  const auto time = times.find(keyword);
  return time == times.end() ? otherwise : time->second;
}

void read_square(WordReader& words, InputProgram& program) {
  program.kind = InputProgram::Kind::Square;
  program.time = parse_time(words.next("a period after 'square'"));
  const Times times = read_times(words, "'for TIME' (how long the input is on) or 'bounce TIME'");
  program.high = time_of(times, "for", program.time / 2);
  program.bounce = time_of(times, "bounce");
}

void read_key(WordReader& words, InputProgram& program) {
  const Times times = read_times(words, "'at TIME', 'every TIME', 'for TIME' or 'bounce TIME'");
  const bool once = times.count("at") != 0;
  if (once && times.count("every") != 0) {
    fail("'at' and 'every' cannot be combined; leave out one of them");
  }
  if (times.count("at") + times.count("every") == 0 || times.count("for") == 0) {
    fail("a key is incomplete; expected 'at TIME' or 'every TIME', and 'for TIME' (how long it is pressed)");
  }
  program.kind = once ? InputProgram::Kind::KeyOnce : InputProgram::Kind::KeyAgain;
  program.time = time_of(times, once ? "at" : "every");
  program.high = time_of(times, "for");
  program.bounce = time_of(times, "bounce");
}

void check(const InputProgram& program) {
  if (program.bounce != VirtualTime(0) && program.bounce < kShortest) {
    fail("expected a bounce of at least " + time_text(kShortest));
  }
  if (program.high < kShortest || program.high < program.bounce) {
    fail("expected the input to be on for at least " + time_text(kShortest) +
         ", and at least as long as the bounce");
  }
  const bool periodic = program.kind != InputProgram::Kind::KeyOnce;
  if (periodic && program.time < program.high + program.bounce + kShortest) {
    fail("the period is too short; the input must stay off for at least " + time_text(kShortest) +
         " longer than it bounces");
  }
}

}  // namespace

unsigned parse_input(const std::string& text, const Model& model) {
  const auto channel = model.inputs == 0 ? std::nullopt : whole_number(text, model.inputs - 1U);
  if (!channel) {
    fail("the " + std::string(model.designation) + " has no input '" + text + "'; it has " +
         (model.inputs == 0 ? "none" : "0 to " + std::to_string(model.inputs - 1)));
  }
  return static_cast<unsigned>(*channel);
}

InputProgram parse_input_program(const std::string& text, const Model& model) {
  WordReader words(words_of(text));
  if (words.done()) {
    fail("the channel is missing; expected 'CHANNEL square PERIOD' or 'CHANNEL key at TIME for TIME'");
  }
  return with_place(text + ": ", [&] {
    const std::string forms = "'square PERIOD' or 'key at TIME for TIME'";
    InputProgram program;
    program.channel = parse_input(words.next("the channel"), model);
    const std::string kind = words.next(forms);
    if (kind == "square") {
      read_square(words, program);
    } else if (kind == "key") {
      read_key(words, program);
    } else {
      fail("'" + kind + "': expected " + forms);
    }
    check(program);
    return program;
  });
}

}  // namespace ex9000::sim
