// The steps of scenarios: the events of a script, and the preparations of a turn.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "tests/firmware/interleaving/scenario.hpp"

namespace ex9000::interleaving {

// --- events ---

inline void nothing(Bench& /*bench*/) {}
inline void silence(Bench& bench) { bench.silence(); }
inline void tick(Bench& bench) { bench.tick(); }
inline void memory_done(Bench& bench) { bench.memory_done(); }
inline void reply_leaves(Bench& bench) { bench.reply_leaves(); }
inline void reply_byte_leaves(Bench& bench) { bench.reply_byte_leaves(); }
inline Step edge(unsigned channel, bool level) {
  return [=](Bench& bench) { bench.edge(channel, level); };
}

/// Returns one step for each byte of a request, and then the step `silence`. The step of the last byte stores
/// the time of this byte in Bench::asked with the key `reply`.
inline std::vector<Step> frame(const std::string& request, const std::string& reply) {
  std::vector<Step> steps;
  for (std::size_t i = 0; i < request.size(); ++i) {
    steps.push_back([=](Bench& bench) {
      bench.byte(static_cast<std::uint8_t>(request[i]));
      if (i + 1 == request.size()) {
        bench.is_asked(reply);
      }
    });
  }
  steps.push_back(silence);
  return steps;
}

inline std::vector<Step> operator+(std::vector<Step> steps, const std::vector<Step>& more) {
  steps.insert(steps.end(), more.begin(), more.end());
  return steps;
}

// --- preparations ---

/// Prepares a turn that begins when a request has been received and the silence timer has expired.
inline Step asked(const std::string& request, const std::string& reply) {
  return [=](Bench& bench) {
    bench.asks(request, reply);
    bench.silence();
  };
}
/// Prepares a turn that begins while the module stores the settings that `request` changes.
inline Step storing(const std::string& request, const std::string& reply) {
  return [=](Bench& bench) {
    bench.asks(request, reply);
    bench.silence();
    bench.whole_turn();
  };
}
/// Prepares a turn that begins when the memory has finished `jobs` + 1 jobs of a store. The module has not
/// processed the end of the last of these jobs yet. If the store has fewer jobs, the store is complete before
/// the turn.
inline Step storing_until(unsigned jobs, const std::string& request, const std::string& reply) {
  return [=](Bench& bench) {
    storing(request, reply)(bench);
    for (unsigned job = 0; job < jobs; ++job) {
      bench.memory_done();
      bench.whole_turn();
    }
    bench.memory_done();
  };
}
/// Prepares a turn that begins while a reply is being sent. `request` must not change settings.
inline Step replying(const std::string& request, const std::string& reply) { return storing(request, reply); }

/// Prepares a turn that begins when the remaining time of the host watchdog is `before`.
inline Step until_expiry(Duration before) {
  return [=](Bench& bench) {
    const Duration remaining = bench.module().host_watchdog_expiry().remaining(Time(bench.hardware().now));
    bench.rest(remaining - before);
  };
}

/// Prepares a turn that begins while a reply is being sent and the next request waits. `request` must change
/// settings.
inline Step replying_with_one_more(const std::string& request, const std::string& reply,
                                   const std::string& next, const std::string& next_reply) {
  return [=](Bench& bench) {
    storing(request, reply)(bench);
    asked(next, next_reply)(bench);
    while (!bench.hardware().driving()) {
      bench.rest(Duration(50));
    }
  };
}

}  // namespace ex9000::interleaving
