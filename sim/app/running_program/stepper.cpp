#include "sim/app/running_program/stepper.hpp"

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "sim/text/durations.hpp"
#include "sim/text/fail.hpp"
#include "sim/text/values.hpp"
#include "sim/text/words.hpp"

namespace ex9000::sim {

namespace {

constexpr const char* kShape = "requires TIME [after N] [quiet], for example advance 250ms after 8 quiet";

}  // namespace

Stepper::Stepper(std::vector<SteppedLine*> lines, VirtualTime end, StopRequested stop_requested)
    : lines_(std::move(lines)), end_(end), stop_requested_(std::move(stop_requested)) {}

bool Stepper::is_advance(const std::string& command) {
  const Words words = words_of(command);
  return !words.empty() && words[0] == "advance";
}

Stepper::Request Stepper::parse(const std::string& command) {
  const Words words = words_of(command);
  if (words.size() < 2) {
    throw std::invalid_argument(kShape);
  }
  Request request;
  request.time = parse_time(words[1]);
  bool counts = false;
  for (std::size_t next = 2; next < words.size(); ++next) {
    if (words[next] == "quiet" && !request.quiet) {
      request.quiet = true;
    } else if (words[next] == "after" && !counts && next + 1 < words.size()) {
      counts = true;
      request.after = parse_whole_number(words[++next], 0, SteppedLine::kMostBytes);
    } else {
      throw std::invalid_argument(kShape);
    }
  }
  return request;
}

void Stepper::advance(const std::string& command, Answer answer) {
  Request request;
  try {
    request = with_place("advance: ", [&] { return parse(command); });
  } catch (const std::invalid_argument& error) {
    answer({std::string("error: ") + error.what(), false});
    return;
  }
  read_ports();  // a pending `advance` may be waiting for these bytes
  if (waiting_) {
    const Waiting replaced = *std::exchange(waiting_, std::nullopt);
    replaced.answer({"error: another 'advance' has replaced this one, which still waited for bytes", false});
  }
  if (bytes_waiting() >= request.after) {
    carry_out(request, answer);
  } else {
    waiting_ = Waiting{request, std::move(answer)};
  }
}

void Stepper::arrived() {
  if (waiting_ && bytes_waiting() >= waiting_->request.after) {
    const Waiting ready = *std::exchange(waiting_, std::nullopt);
    read_ports();
    carry_out(ready.request, ready.answer);
  }
}

void Stepper::read_ports() {
  for (SteppedLine* line : lines_) {
    line->read_ports();
  }
}

std::size_t Stepper::bytes_waiting() const {
  std::size_t bytes = 0;
  for (const SteppedLine* line : lines_) {
    bytes += line->waiting();
  }
  return bytes;
}

void Stepper::carry_out(const Request& request, const Answer& answer) {
  for (SteppedLine* line : lines_) {
    line->put_on_line();
  }
  const bool completed = pass(request);
  for (SteppedLine* line : lines_) {
    line->hand_out();
  }
  if (!completed) {
    answer({"error: the program was asked to end while time passed", false});
    return;
  }
  const VirtualTime now = lines_.front()->now();
  answer({"ok " + seconds_text(now), now >= end_});
}

/// In the order of time across all lines, so that their logs are not printed one after the other: only the
/// line with the next event advances, and all do at the end. false: the program was asked to end before.
bool Stepper::pass(const Request& request) {
  struct State {
    SteppedLine* line;
    VirtualTime next;
    bool pending;
  };
  std::vector<State> states;
  for (SteppedLine* line : lines_) {
    states.push_back({line, line->next(), line->pending()});
  }
  const auto is_earlier = [](const State& a, const State& b) { return a.next < b.next; };
  const auto is_pending = [](const State& state) { return state.pending; };
  VirtualTime now = lines_.front()->now();
  constexpr unsigned kEventsBetweenLooks = 4096;
  unsigned events = 0;
  bool completed = true;
  const VirtualTime until = request.time < end_ - now ? now + request.time : end_;
  while (!request.quiet || std::any_of(states.begin(), states.end(), is_pending)) {
    const auto earliest = std::min_element(states.begin(), states.end(), is_earlier);
    if (earliest->next > until) {
      now = until;
      break;
    }
    if (++events % kEventsBetweenLooks == 0 && stop_requested_()) {
      completed = false;
      break;
    }
    now = std::max(now, earliest->next);
    earliest->line->run_until(now);
    earliest->next = earliest->line->next();
    earliest->pending = earliest->line->pending();
  }
  for (SteppedLine* line : lines_) {
    line->run_until(now);
  }
  return completed;
}

}  // namespace ex9000::sim
