#include "sim/notation/input_notation.hpp"

#include <optional>
#include <sstream>
#include <utility>
#include <vector>

#include "sim/text/durations.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"

namespace ex9000::sim {

namespace {

constexpr VirtualTime kShortest = std::chrono::microseconds(10);

/// Parses durations. Each duration follows its keyword, and no keyword may appear twice.
class Times {
 public:
  explicit Times(std::istringstream& words) {
    for (std::string word; words >> word;) {
      std::string time;
      if (!(words >> time)) {
        fail("expected a duration after '" + word + "'");
      }
      for (const auto& [known, value] : times_) {
        if (known == word) {
          fail("'" + word + "' is given twice; leave out one of them");
        }
      }
      times_.emplace_back(word, parse_time(time));
    }
  }

  /// Removes and returns the duration of a keyword; nullopt if the keyword is not given.
  std::optional<VirtualTime> take(const std::string& word) {
    for (auto time = times_.begin(); time != times_.end(); ++time) {
      if (time->first == word) {
        const VirtualTime value = time->second;
        times_.erase(time);
        return value;
      }
    }
    return std::nullopt;
  }

  void reject_unknown(const std::string& there_are) const {
    if (!times_.empty()) {
      fail("'" + times_.front().first + "': expected " + there_are);
    }
  }

 private:
  std::vector<std::pair<std::string, VirtualTime>> times_;
};

void read_square(std::istringstream& words, InputProgram& program) {
  std::string period;
  if (!(words >> period)) {
    fail("expected a period after 'square'");
  }
  program.kind = InputProgram::Kind::Square;
  program.time = parse_time(period);
  Times times(words);
  program.high = times.take("for").value_or(program.time / 2);
  program.bounce = times.take("bounce").value_or(VirtualTime(0));
  times.reject_unknown("'for TIME' (how long the input is on) or 'bounce TIME'");
}

void read_key(std::istringstream& words, InputProgram& program) {
  Times times(words);
  const auto at = times.take("at");
  const auto every = times.take("every");
  const auto high = times.take("for");
  program.bounce = times.take("bounce").value_or(VirtualTime(0));
  times.reject_unknown("'at TIME', 'every TIME', 'for TIME' or 'bounce TIME'");
  if (at && every) {
    fail("'at' and 'every' cannot be combined; leave out one of them");
  }
  if ((!at && !every) || !high) {
    fail("a key is incomplete; expected 'at TIME' or 'every TIME', and 'for TIME' (how long it is pressed)");
  }
  program.kind = at ? InputProgram::Kind::KeyOnce : InputProgram::Kind::KeyAgain;
  program.time = at ? *at : *every;
  program.high = *high;
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
  std::istringstream words(text);
  std::string channel;
  if (!(words >> channel)) {
    fail("the channel is missing; expected 'CHANNEL square PERIOD' or 'CHANNEL key at TIME for TIME'");
  }
  return with_place(text + ": ", [&] {
    std::string kind;
    words >> kind;
    InputProgram program;
    program.channel = parse_input(channel, model);
    if (kind == "square") {
      read_square(words, program);
    } else if (kind == "key") {
      read_key(words, program);
    } else {
      fail("'" + kind + "': expected 'square PERIOD' or 'key at TIME for TIME'");
    }
    check(program);
    return program;
  });
}

}  // namespace ex9000::sim
