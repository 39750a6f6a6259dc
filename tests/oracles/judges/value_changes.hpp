// Decides whether a change of a module's values has a permitted cause: an independent implementation of
// wire.md 4, 6, 7 and 12.
#pragma once

#include <cstddef>
#include <cstdint>

#include "tests/oracles/judges/demand.hpp"
#include "tests/oracles/judges/host_watchdog.hpp"
#include "tests/oracles/judges/requests.hpp"
#include "tests/oracles/judges/time.hpp"
#include "tests/oracles/judges/timed_outputs.hpp"

namespace ex9000::judges {

/// Stores the values of a module. Checks whether received requests, a timeout of the host watchdog and ended
/// timers of outputs explain a change of the values.
class ValueChanges {
 public:
  /// Call this when the module has started with `values`. `reset`: the time of the reset.
  void module_reset(const Values& values, Microseconds reset) {
    values_ = values;
    watchdog_.module_reset(reset);
  }

  /// Returns the values after all changes so far.
  [[nodiscard]] const Values& values() const { return values_; }
  HostWatchdog& watchdog() { return watchdog_; }

  /// Call this for each received request other than a host OK.
  void note(const Request& request) { timers_.may_be_restarted(request.demand, request.last); }

  /// Returns the claim that a change of the values to `to` violates, or null if the change has a permitted
  /// cause. A request can cause a change only if it is `fresh` and not `done`. Call `change` after this
  /// function.
  const char* objection_to_change(const Values& to, Requests& requests, Microseconds now) {
    if (one_leads_to(to, requests, now)) {
      return nullptr;
    }
    if (to.timed_out && !values_.timed_out && !watchdog_.may_expire(values_, now)) {
      return "the host watchdog never expires too early";
    }
    const Causes causes{requests, now};
    return some_lead(values_, to, causes, 0, kMostInATurn)
               ? nullptr
               : "values change only because of a command, a timeout, an ended timer or a reset";
  }

  /// Stores the new values `to`, and the earliest ends of the timers that have started. `requests`: those
  /// that may have started the timers.
  void change(const Values& to, const Requests& requests) {
    const auto started = static_cast<std::uint16_t>(to.timed & ~values_.timed);
    if (started != 0) {
      timers_.started(started);
      for (std::size_t i = 0; i < requests.size(); ++i) {
        timers_.may_be_started_by(requests[i].demand, requests[i].last, started);
      }
    }
    values_ = to;
  }

  /// Returns whether the host watchdog has expired since the request was received.
  [[nodiscard]] bool has_expired_since(const Request& request) const {
    return watchdog_.has_expired_since(request.last);
  }
  /// Returns whether the values are possible after the request. `since`: see Demand::is_met_by.
  [[nodiscard]] bool meet(const Request& request, bool since) const {
    return request.demand.is_met_by(values_, watchdog_.outputs_before(), since);
  }

 private:
  /// An upper bound for the number of commands that take effect in one turn of the main loop. A turn
  /// completes the store of at most one command, and then executes at most one waiting frame.
  static constexpr unsigned kMostInATurn = 3;

  struct Causes {
    const Requests& requests;
    Microseconds now;
  };

  [[nodiscard]] bool leads(const Request& request, const Values& from, const Values& to) const {
    const Demand& demand = request.demand;
    return request.fresh && !request.done && demand.changes_values() &&
           (demand.made_of(from) == to ||
            (from.timed_out && has_expired_since(request) &&
             demand.values_after_a_timeout(from, watchdog_.outputs_before()) == to));
  }

  /// Returns whether a single command can have changed the values to `to`. If so, records the cause: the
  /// timeout if a timeout is also possible, otherwise the command if no other command is possible.
  bool one_leads_to(const Values& to, Requests& requests, Microseconds now) {
    Request* only = nullptr;
    unsigned count = 0;
    for (std::size_t i = 0; i < requests.size(); ++i) {
      if (leads(requests[i], values_, to)) {
        only = &requests[i];
        ++count;
      }
    }
    if (count != 0 && watchdog_.may_expire(values_, now) && to == values_.expired()) {
      // The host watchdog may have expired instead.
      watchdog_.expired(values_, now);
    } else if (count == 1) {
      only->done = true;
      if (only->demand.restarts) {
        watchdog_.restarted(now);
      }
    }
    return count != 0;
  }

  /// Returns whether ended timers, a timeout and at most `most` of the requests from index `next` on can have
  /// changed `from` to `to`. If so, and if a timeout is one of the causes, records the timeout.
  bool some_lead(const Values& from, const Values& to, const Causes& causes, std::size_t next,
                 unsigned most) {
    if (from == to) {
      return true;
    }
    const auto ended = static_cast<std::uint16_t>(from.timed & ~to.timed & timers_.that_may_end(causes.now));
    if (ended != 0 && some_lead(from.without_timers(ended), to, causes, next, most)) {
      return true;
    }
    if (watchdog_.may_expire(from, causes.now)) {
      const HostWatchdog before = watchdog_;
      watchdog_.expired(from, causes.now);
      if (some_lead(from.expired(), to, causes, next, most)) {
        return true;
      }
      watchdog_ = before;
    }
    for (std::size_t i = next; most != 0 && i < causes.requests.size(); ++i) {
      const Request& each = causes.requests[i];
      if (leads(each, from, to)) {
        return true;
      }
      if (each.fresh && !each.done && each.demand.changes_values()) {
        if (some_lead(each.demand.made_of(from), to, causes, i + 1, most - 1)) {
          return true;
        }
        if (from.timed_out && has_expired_since(each) &&
            some_lead(each.demand.values_after_a_timeout(from, watchdog_.outputs_before()), to, causes, i + 1,
                      most - 1)) {
          return true;
        }
      }
    }
    return false;
  }

  Values values_;
  HostWatchdog watchdog_;
  TimedOutputs timers_;
};

}  // namespace ex9000::judges
