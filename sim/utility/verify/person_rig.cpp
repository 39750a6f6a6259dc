#include "sim/utility/verify/person_rig.hpp"

#include "sim/text/values.hpp"
#include "sim/text/words.hpp"

namespace ex9000::utility {

namespace {

constexpr const char* kDone = "; Enter: done, s: cannot be done ";

[[noreturn]] void cannot(const std::string& request) {
  throw NotVerified("nobody could do '" + request + "'");
}

std::string question_of(const sim::Words& words) {
  const std::string& what = words[0];
  if (what == "power") {
    return "Switch the supply " + words[1] + kDone;
  }
  if (what == "init") {
    return (words[1] == "on" ? "Connect INIT* to GND" : "Disconnect INIT*") + std::string(kDone);
  }
  if (what == "input") {
    return "Switch input " + words[1] + " " + words[2] + kDone;
  }
  if (what == "outputs") {
    return "Which outputs are on? For example 0 3 12; Enter: none, s: not visible ";
  }
  return "Is the status LED on, off or flashing? s: not visible ";
}

std::string outputs_in(const std::string& answer) {
  constexpr unsigned kLast = 15;
  unsigned outputs = 0;
  for (const std::string& word : sim::words_of(answer)) {
    outputs |= 1U << sim::parse_whole_number(word, 0, kLast);
  }
  return sim::hex_word_text(outputs);
}

}  // namespace

/// A contact that a person closes bounces, which modules count. Few modules have a terminal for a reset.
bool PersonRig::never_does(const std::string& word) const { return word == "pulse" || word == "reset"; }

std::string PersonRig::ask(const std::string& request) {
  const sim::Words words = sim::words_of(request);
  if (never_does(words[0])) {
    cannot(request);
  }
  const std::string question = question_of(words);
  for (;;) {
    const std::optional<std::string> answer = ask_person_(question);
    if (!answer) {
      throw Interrupted();
    }
    if (*answer == "s") {
      cannot(request);
    }
    if (words[0] == "led" && (*answer == "on" || *answer == "off" || *answer == "flashing")) {
      return *answer;
    }
    if (words[0] != "led" && words[0] != "outputs" && answer->empty()) {
      return "";
    }
    try {
      if (words[0] == "outputs") {
        return outputs_in(*answer);
      }
    } catch (const std::invalid_argument&) {  // NOLINT(bugprone-empty-catch)
      // asked again
    }
  }
}

}  // namespace ex9000::utility
