// Schedules the faults of a line and applies them, for tests and for users.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/virtual_line/faults/chance.hpp"
#include "sim/virtual_line/faults/echo.hpp"
#include "sim/virtual_line/faults/fault.hpp"
#include "sim/virtual_line/faults/noise.hpp"
#include "sim/virtual_line/wires/master.hpp"
#include "sim/virtual_line/wires/module.hpp"
#include "sim/virtual_line/wires/wires.hpp"

namespace ex9000::sim {

/// The same faults, the same seed and the same traffic produce the same occurrences at the same times. Only
/// Wires and this class call `run`. Call `add`, `remove` and `remove_all` only while Wires::run_next is not
/// running.
class Faults final : public Station {
 public:
  using Modules = std::vector<std::unique_ptr<SimulatedModule>>;
  /// Receives one line of text for people when a fault occurs or ends by itself. Faults that depend on
  /// replies and faults without a schedule (Schedule::When::Always) are not reported.
  using Notice = std::function<void(const std::string&)>;

  /// Attaches itself to `wires`. `master` has the line's mode; `notice` may be empty. `modules` and this
  /// object must live as long as Wires and the master are used.
  Faults(Wires& wires, Master& master, Modules& modules, std::uint64_t seed, Notice notice);
  Faults(const Faults&) = delete;
  Faults& operator=(const Faults&) = delete;

  /// Adds a fault and returns its number, counted from 1. A fault without a schedule begins immediately.
  /// Throws std::invalid_argument if the line does not have the fault's module, or if the scheduled time has
  /// passed.
  std::size_t add(Fault fault);
  /// Removes a fault and ends its effects, with three exceptions: a hang does not end, a reply that has begun
  /// may stay lost, late, changed or at the wrong rate, and bytes that the fault has already queued are still
  /// sent. Returns false if no fault has this number.
  bool remove(std::size_t number);
  void remove_all();

  struct Info {
    std::size_t number;
    std::string text;
    std::optional<std::size_t> module;
    /// The number of occurrences in progress: at most 1, or at most 1 for each module if the fault depends on
    /// replies.
    std::size_t in_progress;
    std::uint64_t occurrences_so_far;
  };
  /// The number of faults that `list` keeps after they have ended by themselves.
  static constexpr std::ptrdiff_t kMostEnded = 100;
  /// Returns the faults in the order of their numbers, with the last kMostEnded faults that have ended by
  /// themselves.
  [[nodiscard]] std::vector<Info> list() const;

  /// Returns whether an echo or a foreign station has bytes to send, or an effect has not been applied yet.
  [[nodiscard]] bool pending() const { return changed_ || echo_.sending() || stranger_.sending(); }

  // --- Station ---
  void run() override;

 private:
  /// Key of an occurrence that no reply has triggered. It affects everything that the fault affects.
  static constexpr std::size_t kEverywhere = std::numeric_limits<std::size_t>::max();

  /// A fault that was added, with its occurrences in progress.
  struct Scheduled {
    Fault fault;
    VirtualTime begins = kNever;  ///< the next scheduled time, in the line's time; kNever: none
    /// Where the fault is active (a module whose reply has triggered it, or kEverywhere), and until when.
    /// kNever: until the end of the reply, or until the fault is removed.
    std::map<std::size_t, VirtualTime> active = {};
    std::uint64_t counted = 0;  ///< number of replies or writes that the schedule has counted
    std::uint64_t occurrences_so_far = 0;

    [[nodiscard]] bool is_of(std::size_t module) const { return fault.module.value_or(module) == module; }
    [[nodiscard]] bool is_active_at(std::size_t place) const {
      return is_of(place) && (active.count(kEverywhere) != 0 || active.count(place) != 0);
    }
    /// Returns whether the fault is not in progress and will never occur again.
    [[nodiscard]] bool has_ended() const;
  };

  void change();
  void reply_begins(std::size_t module, Reply& reply);
  void written(std::size_t module);
  void begin(Scheduled& scheduled, std::size_t place);
  template <class Over>
  void end_where(Over over);
  void say(const Scheduled& scheduled, const std::string& what) const;
  void take_effect();
  template <class Effect, class... Affected>
  void apply_at(std::size_t place, Affected&&... affected) const;

  Wires& wires_;
  WireEnd& end_;
  Modules& modules_;
  Notice notice_;
  Chance chance_;
  Noise noise_;
  Echo echo_;
  Master stranger_;  ///< the sender of foreign traffic
  std::vector<Scheduled> scheduled_;
  std::size_t numbers_ = 0;
  bool changed_ = false;  ///< the next call of `run` must update the effects
};

}  // namespace ex9000::sim
