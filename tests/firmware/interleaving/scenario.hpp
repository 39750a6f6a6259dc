// Events that happen to a module before, during or after one turn of its main loop, and the expected outcome.
#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "tests/firmware/interleaving/bench.hpp"

namespace ex9000::interleaving {

using Step = std::function<void(Bench&)>;

struct Scenario {
  const char* name;
  const char* model;
  /// Changes the settings with which the module starts. Without this change, they are the factory settings
  /// with 115200 baud.
  std::function<void(Settings&)> settings;
  Step before;               ///< prepares the module for the turn
  std::vector<Step> script;  ///< the events in their order; each occurs before, during or after the turn
  /// The permitted lists of replies, from the start of `before` until the module is idle.
  std::vector<std::vector<std::string>> replies;
  /// Returns the parts of the outcome; may throw std::logic_error. See outcomes.hpp.
  std::function<std::vector<std::string>(Bench&)> comes_to;
  std::string probe;          ///< a request that is sent at the end
  std::string probe_reply;    ///< the expected reply to `probe`
  std::uint32_t turn_around;  ///< the minimum time before each reply, in microseconds
  bool restless = false;      ///< after the turn, the main loop is woken every 10 us for 5 ms
};

/// The point of the turn at which each step of a script happens. If the turn does not reach this point, the
/// step happens after the turn.
using Places = std::vector<int>;
inline constexpr int kBeforeTheTurn = -1;
inline constexpr int kAfterTheTurn = 1'000'000;

struct Run {
  std::vector<std::string> outcome;  ///< in parts that are independent of each other
  unsigned points = 0;
};

inline std::string all_of(const std::vector<std::string>& texts) {
  std::string all;
  for (const std::string& text : texts) {
    all += "[";
    for (const char character : text) {
      constexpr const char* kDigits = "0123456789ABCDEF";
      const auto byte = static_cast<unsigned char>(character);
      if (byte >= 0x20 && byte < 0x7F) {
        all.push_back(character);
      } else {
        all += std::string("\\") + kDigits[byte >> 4U] + kDigits[byte & 0xFU];
      }
    }
    all += "]";
  }
  return all;
}

inline void require(bool holds, const std::string& what) {
  if (!holds) {
    throw std::logic_error(what);
  }
}

/// Checks the minimum time between two replies, and between a request in `asked` and the reply to it.
inline void require_distances(const Bench& bench, const Chip& hardware, const Scenario& scenario) {
  const std::vector<Sent>& sent = hardware.sent;
  for (std::size_t i = 0; i < sent.size(); ++i) {
    if (i != 0) {
      require(sent[i].started - sent[i - 1].ended >= scenario.turn_around, "two replies are too close");
    }
    const auto asked = bench.asked.find(sent[i].bytes);
    if (asked != bench.asked.end()) {
      require(sent[i].started - asked->second >= scenario.turn_around, "a reply is too early");
    }
  }
}

/// Plays `scenario` with its steps at `places`. Checks the conditions that must hold for every order of
/// events. Throws std::logic_error if one of these conditions does not hold.
inline Run play(const Scenario& scenario, const Places& places) {
  Bench bench(scenario.model, scenario.settings);
  Chip& hardware = bench.hardware();
  scenario.before(bench);
  const unsigned feeds_before = hardware.feeds;
  std::size_t next = 0;
  const auto deliver_until = [&](int point) {
    while (next < scenario.script.size() && places[next] <= point) {
      scenario.script[next++](bench);
    }
  };
  deliver_until(kBeforeTheTurn);
  Run run;
  run.points = Points::watch([&](unsigned point) { deliver_until(static_cast<int>(point)); },
                             [&] { bench.whole_turn(); });
  deliver_until(kAfterTheTurn);
  if (scenario.restless) {
    bench.rest_restlessly(milliseconds(5));
  }
  bench.rest(milliseconds(25));

  std::vector<std::string> replies;
  for (const Sent& sent : hardware.sent) {
    replies.push_back(sent.bytes);
  }
  bool foreseen = false;
  for (const auto& foreseen_replies : scenario.replies) {
    foreseen |= replies == foreseen_replies;
  }
  require(foreseen, "unexpected replies: " + all_of(replies));
  require(!hardware.driving(), "the driver is still on");
  require(hardware.feeds > feeds_before, "the hardware watchdog was not fed");
  run.outcome = scenario.comes_to(bench);
  require_distances(bench, hardware, scenario);

  bench.bytes(scenario.probe);
  bench.rest(milliseconds(10));
  require(hardware.sent.size() == replies.size() + 1, "expected exactly one reply to the probe");
  require(hardware.sent.back().bytes == scenario.probe_reply,
          "the reply to the probe was " + all_of({hardware.sent.back().bytes}));
  return run;
}

}  // namespace ex9000::interleaving
