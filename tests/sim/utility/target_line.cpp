#include "tests/sim/utility/target_line.hpp"

#include <algorithm>

#include "sim/app/play/playing.hpp"
#include "sim/app/play/steps.hpp"
#include "sim/text/values.hpp"
#include "sim/utility/command/program.hpp"

namespace ex9000::utility {

TargetLine::TargetLine(play::Target& target, hal::SerialMode mode, std::function<Time()> now)
    : target_(target), now_(std::move(now)) {
  TargetLine::set_mode(mode);
}

void TargetLine::set_mode(hal::SerialMode mode) {
  target_.set_baud(mode.baud);
  target_.set_format(mode.format);
}

Data TargetLine::receive(Time patience) {
  const Time end = now() + patience;
  const auto whole = std::chrono::duration_cast<std::chrono::milliseconds>(patience);
  const Data bytes = whole > Time(0) ? target_.receive(1, whole) : Data();
  return bytes.empty() ? target_.listen(std::max(end - now(), Time(0))) : bytes;
}

std::string TargetRig::ask(const std::string& request) {
  if (request == "outputs") {
    return sim::hex_word_text(target_.outputs());
  }
  if (request == "led") {
    return play::led_text(target_.led(play::Led::Flashing));
  }
  play::Playing playing(target_, false, true);  // without listening before the step
  play::parse_step(0, request, nullptr).run(playing);
  return "";
}

void Program::clear() {
  output_.str("");
  error_.str("");
}

Environment Program::environment() {
  return {[this](const Port& /*port*/, hal::SerialMode mode) { return open_(mode); }, output_, error_};
}

int Program::run(const std::vector<std::string>& words) {
  std::vector<const char*> argv{"ex9000"};
  for (const std::string& word : words) {
    argv.push_back(word.c_str());
  }
  clear();
  Environment environment = this->environment();
  return run_program(static_cast<int>(argv.size()), argv.data(), environment);
}

}  // namespace ex9000::utility
