#include "tests/world/judge.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <set>

#include "tests/oracles/reference/hexadecimal.hpp"

namespace ex9000::world {

namespace {

/// With more states, the judge gives up.
constexpr std::size_t kMost = 200;

std::string hex_of(const Bytes& bytes) {
  std::string text;
  for (const std::uint8_t byte : bytes) {
    text += reference::hex(byte, 2);
  }
  return text;
}

/// Adds a state, unless one like it is there. Returns its position if that changes anything.
std::optional<std::size_t> add(std::vector<Possible>& all, Possible&& one) {
  const auto like =
      std::find_if(all.begin(), all.end(), [&](const Possible& each) { return each.is_like(one); });
  const auto at = static_cast<std::size_t>(like - all.begin());
  if (like != all.end()) {
    return like->widen(one) ? std::optional(at) : std::nullopt;
  }
  all.push_back(std::move(one));
  return at;
}

}  // namespace

Judge::Judge(const reference::ModelRow& row, Object object)
    : all_{Possible(row)}, object_(std::move(object)) {}

/// Lets time pass: adds what may have happened by now, and removes what contradicts the outputs.
void Judge::pass(Time now) {
  if (gave_up_) {
    return;
  }
  std::vector<Possible> after;
  const auto stays = [&](const Possible& state) {
    return state.futures(since_, now, after) && state.outputs() == outputs_ &&
           (lit_ ? state.may_be_lit(lit_since_, now) : state.may_be_dark(lit_since_, now));
  };
  if (std::all_of(all_.begin(), all_.end(), stays) && after.empty()) {
    since_ = now;
    return;
  }
  std::vector<Possible> seen = all_;
  std::vector<bool> stay(seen.size());
  std::vector<std::size_t> open(seen.size());
  std::iota(open.begin(), open.end(), std::size_t{0});
  while (!open.empty() && seen.size() <= 4 * kMost) {
    const std::size_t at = open.back();
    open.pop_back();
    after.clear();
    const Possible present = seen[at];
    stay[at] = stays(present);
    for (Possible& each : after) {
      if (const auto changed = add(seen, std::move(each))) {
        open.push_back(*changed);
      }
    }
    stay.resize(seen.size());
  }
  std::vector<Possible> found;
  for (std::size_t at = 0; at < seen.size(); ++at) {
    if (stay[at]) {
      found.push_back(seen[at]);
    }
  }
  if (seen.size() > 4 * kMost) {
    gave_up_ = true;
    return;
  }
  replace(std::move(found), now, "nothing happens");
  since_ = now;
}

void Judge::replace(std::vector<Possible> by, Time now, const std::string& what) {
  if (!by.empty()) {
    gave_up_ = gave_up_ || by.size() > kMost;
    all_ = std::move(by);
    return;
  }
  std::string objection = std::to_string(now.count()) + ": " + what + ", but the module may only be in:";
  std::set<std::string> texts;
  for (const Possible& each : all_) {
    texts.insert("\n  " + each.text());
  }
  for (const std::string& text : texts) {
    objection += text;
  }
  object_(objection);
}

template <class Change>
void Judge::each(Time now, Change change) {
  pass(now);
  for (Possible& each : all_) {
    change(each);
  }
}

void Judge::fork(Time now, const std::string& what,
                 const std::function<std::vector<Possible>(const Possible&)>& after) {
  if (gave_up_) {
    return;
  }
  std::vector<Possible> next;
  for (const Possible& each : all_) {
    for (Possible& one : after(each)) {
      add(next, std::move(one));
    }
  }
  replace(std::move(next), now, what);
}

void Judge::set_serial_number_of_board(unsigned number) {
  for (Possible& each : all_) {
    each.module().set_serial_number_of_board(number);
  }
}

void Judge::store(const reference::Stored& stored) {
  for (Possible& each : all_) {
    each.store(stored);
  }
}

void Judge::power(bool on, Time now) {
  pass(now);
  if (on) {
    each(now, [&](Possible& each) { each.power_on(now); });
  } else {
    fork(now, "power off", [](const Possible& each) { return each.power_off(); });
    outputs_ = 0;
  }
}

void Judge::reset(unsigned reason, Time now) {
  pass(now);
  fork(now, "reset", [&](const Possible& each) { return each.reset(reason, now); });
  outputs_ = 0;
}

void Judge::hang(Time time, Time now) {
  each(now, [&](Possible& each) { each.hang(time, now); });
}

void Judge::tick_stops(Time now) {
  each(now, [&](Possible& each) { each.tick_stops(now); });
}

void Judge::init(bool asserted, Time now) {
  each(now, [&](Possible& each) { each.init(asserted, now); });
}

void Judge::memory_fails(bool fails, Time now) {
  each(now, [&](Possible& each) { each.memory_fails(fails, now); });
}

void Judge::slots_fail(bool fails, Time now) {
  each(now, [&](Possible& each) { each.slots_fail(fails, now); });
}

void Judge::start_bad_images(bool bad, Time now) {
  each(now, [&](Possible& each) { each.start_bad_images(bad); });
}

void Judge::input(unsigned channel, bool level, Time now) {
  each(now, [&](Possible& each) { each.input(channel, level, now); });
}

void Judge::pulse(unsigned channel, std::uint32_t count, Time now) {
  each(now, [&](Possible& each) { each.pulse(channel, count, now); });
}

void Judge::hear(std::uint8_t byte, bool good, Time end) {
  pass(end);
  fork(end, "hears", [&](const Possible& each) { return each.hear(byte, good, end); });
}

/// The states before the change have `outputs_`; an event leads to the new outputs.
void Judge::drive(unsigned outputs, Time now) {
  outputs_ = outputs;
  pass(now);
}

void Judge::light(bool on, Time now) {
  pass(now);
  lit_ = on;
  lit_since_ = now;
  if (!on) {
    fork(now, "the LED goes out", [](const Possible& each) {
      return each.may_be_dark() ? std::vector<Possible>{each} : std::vector<Possible>();
    });
  }
}

void Judge::listen(unsigned rate, LineFormat format, Time now) {
  pass(now);
  fork(now, "listens at " + std::to_string(rate),
       [&](const Possible& each) { return each.listen(rate, format, now); });
}

void Judge::reply(const Bytes& bytes, Time begins) {
  pass(begins);
  fork(begins, "replies " + hex_of(bytes), [&](const Possible& each) { return each.reply(bytes, begins); });
}

void Judge::replied(Time end) {
  each(end, [&](Possible& each) { each.replied(end); });
}

}  // namespace ex9000::world
