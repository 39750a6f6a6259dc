// Schedules the faults of a line and applies them, for tests and for users.
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/virtual_line/bus/bus.hpp"
#include "sim/virtual_line/bus/master.hpp"
#include "sim/virtual_line/bus/module.hpp"
#include "sim/virtual_line/bus_faults/chance.hpp"
#include "sim/virtual_line/bus_faults/echo.hpp"
#include "sim/virtual_line/bus_faults/fault.hpp"
#include "sim/virtual_line/bus_faults/noise.hpp"

namespace ex9000::sim {

/// The same faults, the same seed and the same traffic produce the same occurrences at the same times. Only
/// the bus and this class call `run`. Call `add`, `remove` and `remove_all` only while Bus::run_next is not
/// running.
class Faults final : public Station {
 public:
  using Modules = std::vector<std::unique_ptr<SimulatedModule>>;
  /// Receives one line of text for people when a fault occurs or ends by itself. Faults that depend on
  /// replies and faults without a schedule (Schedule::When::Always) are not reported.
  using Notice = std::function<void(const std::string&)>;

  /// Attaches itself to `bus`. `master` has the line's mode; `notice` may be empty. `master`, `modules` and
  /// this object must live as long as the bus is used.
  Faults(Bus& bus, Master& master, Modules& modules, std::uint64_t seed, Notice notice);
  Faults(const Faults&) = delete;
  Faults& operator=(const Faults&) = delete;

  /// Adds a fault and returns its number, counted from 1. A fault without a schedule begins immediately.
  /// Throws std::invalid_argument if the line does not have the fault's module, or if the scheduled time has
  /// passed.
  std::size_t add(const Fault& fault);
  /// Removes a fault and ends its effects, with three exceptions: a hang does not end, a reply that has begun
  /// may stay lost, late or at the wrong rate, and bytes that the fault has already queued are still sent.
  /// Returns false if no fault has this number.
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
  static constexpr std::size_t kMostEnded = 100;
  /// Returns the faults in the order of their numbers, with the last kMostEnded faults that have ended by
  /// themselves.
  [[nodiscard]] std::vector<Info> list() const;

  /// Returns whether an echo or a foreign station has bytes to send, or an effect has not been applied yet.
  [[nodiscard]] bool pending() const;

  // --- Station ---
  void run() override;

 private:
  /// One occurrence that is in progress or waits for its reply.
  struct Occurrence {
    /// The module whose reply triggered the occurrence. If the fault affects modules, the occurrence affects
    /// only this module. nullopt: no reply triggered the occurrence.
    std::optional<std::size_t> reply_of;
    /// The end in the line's time; kNever while `waits` is true. Otherwise, kNever means that an occurrence
    /// that a reply triggered ends with this reply, and that any other occurrence does not end by itself.
    VirtualTime ends = kNever;
    /// For noise that a reply triggered: the number of this reply, counted from 1 for each module.
    std::uint64_t reply = 0;
    bool waits = false;  ///< for noise that a reply triggered: true until this reply is on the wires
  };
  /// A fault that was added, with its occurrences.
  struct Armed {
    std::size_t number = 0;
    Fault fault;
    VirtualTime begins = kNever;  ///< the next scheduled time, in the line's time; kNever: none
    std::vector<Occurrence> occurrences;
    std::uint64_t counted = 0;  ///< number of replies or writes that the schedule has counted
    std::uint64_t occurrences_so_far = 0;

    /// Returns the number of occurrences in progress. Does not count occurrences that wait for their reply.
    [[nodiscard]] std::size_t in_progress() const;
    [[nodiscard]] bool occurs_at(std::size_t module) const;
    /// Returns whether the fault is not in progress and will never occur again.
    [[nodiscard]] bool has_ended() const;
    [[nodiscard]] Info info() const {
      return {number, fault.text, fault.module, in_progress(), occurrences_so_far};
    }
  };

  [[nodiscard]] VirtualTime next() const;
  void change();
  ReplyFate reply_begins(std::size_t module, std::uint64_t reply);
  void reply_ends(std::size_t module);
  void reply_on_the_wires(std::size_t module, std::uint64_t reply, bool on);
  void written(std::size_t module);
  void begin(Armed& armed, std::optional<std::size_t> reply_of = std::nullopt, std::uint64_t reply = 0);
  void end_effects(std::optional<std::size_t> removed);
  template <class Over>
  void end_occurrences(Armed& armed, Over over);
  void put_ended_aside();
  void say(const Armed& armed, const std::string& what) const;
  void take_effect();
  void prepare(Trouble trouble);
  [[nodiscard]] const Armed* active(Trouble trouble, std::size_t module) const;
  [[nodiscard]] bool affected_by(Trouble trouble, std::size_t module) const {
    return active(trouble, module) != nullptr;
  }
  [[nodiscard]] double rate_of(Trouble trouble) const;
  void set_noise();
  void set_echo();

  Bus& bus_;
  BusEnd& end_;
  Master& master_;
  Modules& modules_;
  Notice notice_;
  Chance chance_;
  std::vector<Armed> armed_;
  std::deque<Info> ended_;  ///< faults that have ended by themselves; only `list` and `remove` use them
  std::size_t numbers_ = 0;
  bool changed_ = false;  ///< the next call of `run` must update the effects
  std::vector<std::size_t> hanging_;
  std::vector<std::vector<std::uint8_t>> to_say_;
  // Each of these objects is created when a fault first requires it.
  std::unique_ptr<Noise> noise_;
  std::unique_ptr<Echo> echo_;
  std::unique_ptr<Master> stranger_;
};

}  // namespace ex9000::sim
