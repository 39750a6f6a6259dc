// Schedules the faults of a line and applies them.
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

/// The same faults, seed and traffic give the same occurrences at the same times. Add and remove faults only
/// while Wires::run_next is not running.
class Faults final : public Station {
 public:
  using Modules = std::vector<std::unique_ptr<SimulatedModule>>;
  /// Gets one line for people when a fault with a time or a count of writes occurs or ends by itself.
  using Notice = std::function<void(const std::string&)>;

  /// `notice` may be empty. `modules` and this object must outlive all use of `wires` and `master`.
  Faults(Wires& wires, Master& master, Modules& modules, std::uint64_t seed, Notice notice);
  Faults(const Faults&) = delete;
  Faults& operator=(const Faults&) = delete;

  /// Returns its number, from 1. std::invalid_argument: the line lacks the module, or the time has passed.
  std::size_t add(Fault fault);
  /// Ends the effects too, except: a hang goes on, a reply that has begun may stay lost, late, changed or at
  /// the wrong rate, and queued bytes are still sent. false: no such fault.
  bool remove(std::size_t number);
  void remove_all();

  struct Info {
    std::size_t number;
    std::string text;
    std::optional<std::size_t> module;
    /// At most 1, or 1 for each module if the fault depends on replies.
    std::size_t in_progress;
    std::uint64_t occurrences_so_far;
  };
  /// `list` keeps this many faults that have ended by themselves.
  static constexpr std::ptrdiff_t kMostEnded = 100;
  /// In the order of their numbers.
  [[nodiscard]] std::vector<Info> list() const;

  [[nodiscard]] bool pending() const { return changed_ || echo_.sending() || stranger_.sending(); }

  void run() override;

 private:
  /// The key of an occurrence that no reply has triggered: it affects all that the fault affects.
  static constexpr std::size_t kEverywhere = std::numeric_limits<std::size_t>::max();

  struct Scheduled {
    Fault fault;
    VirtualTime begins = kNever;  ///< the next scheduled time, in the line's time; kNever: none
    /// By place: a module whose reply triggered it, or kEverywhere. kNever: until the reply ends, or removal.
    std::map<std::size_t, VirtualTime> active = {};
    std::uint64_t counted = 0;  ///< number of replies or writes that the schedule has counted
    std::uint64_t occurrences_so_far = 0;

    [[nodiscard]] bool is_of(std::size_t module) const { return fault.module.value_or(module) == module; }
    [[nodiscard]] bool is_active_at(std::size_t place) const {
      return is_of(place) && (active.count(kEverywhere) != 0 || active.count(place) != 0);
    }
    /// Not active, and will never be again.
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
