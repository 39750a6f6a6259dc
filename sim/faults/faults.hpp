// What goes wrong on a line, and when: one component for tests and users alike.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "sim/bus.hpp"
#include "sim/faults/chance.hpp"
#include "sim/faults/echo.hpp"
#include "sim/faults/fault.hpp"
#include "sim/faults/noise.hpp"
#include "sim/master.hpp"
#include "sim/module.hpp"

namespace ex9000::sim {

/// The same faults with the same seed on the same line strike at the same moments.
class Faults final : public Station {
 public:
  using Modules = std::vector<std::unique_ptr<SimulatedModule>>;
  /// A line for people on what strikes and what is over, as it does: not of each reply, nor of what is
  /// always so.
  using Notice = std::function<void(const std::string&)>;

  /// Attaches itself to `bus`. `master` has the line's rate; `notice` may be empty. All live as long as the
  /// bus is used.
  Faults(Bus& bus, const Master& master, Modules& modules, std::uint64_t seed, Notice notice);
  Faults(const Faults&) = delete;
  Faults& operator=(const Faults&) = delete;

  /// From now on; returns its number, from 1. Between two runs of the bus, like the rest. Throws
  /// std::invalid_argument where the line lacks the module, or the moment is over.
  std::size_t add(const Fault& fault);
  /// It strikes no more, and what it did is over. False: there is none of this number.
  bool remove(std::size_t number);
  void remove_all();

  struct Told {
    std::size_t number;
    std::string text;
    std::optional<std::size_t> module;
    std::size_t strikes;  ///< that last at this moment: one, or of replies one a module
    std::uint64_t strikes_so_far;
  };
  [[nodiscard]] std::vector<Told> told() const;

  /// An echo or a stranger has bytes to send, or an effect is to be set.
  [[nodiscard]] bool pending() const;

  // --- Station ---
  [[nodiscard]] VirtualTime next() const override;
  void run() override;
  [[nodiscard]] std::uint32_t baud() const override { return 0; }
  void receive(std::uint8_t /*byte*/, ByteStatus /*status*/) override {}

 private:
  /// While it lasts.
  struct Strike {
    std::optional<std::size_t> reply_of;  ///< it is of this module's reply, and befalls no other
    VirtualTime ends = kNever;            ///< by the clock; never, of a reply: with that
    std::uint64_t reply = 0;              ///< that one, in the module's count, where it befalls the wires
    bool waits = false;                   ///< until that is on them
  };
  struct Armed {
    std::size_t number = 0;
    Fault fault;
    VirtualTime begins = kNever;  ///< by the clock
    std::vector<Strike> strikes;  ///< at this moment: one, or of replies one a module
    std::uint64_t counted = 0;    ///< replies, or writes
    std::uint64_t strikes_so_far = 0;

    /// Not those that wait.
    [[nodiscard]] std::size_t strikes_now() const;
    [[nodiscard]] bool befalls(std::size_t module) const;
  };

  ReplyFate reply_begins(std::size_t module);
  void reply_ends(std::size_t module);
  void reply_on_the_wires(std::size_t module, std::uint64_t reply, bool on);
  void written(std::size_t module);
  void strike(Armed& armed, std::optional<std::size_t> reply_of);
  static void forget_others_of(Armed& armed, const Strike& latest);
  void let_late_replies_go();
  template <class Over>
  void relent(Armed& armed, Over over);
  void say(const Armed& armed, const std::string& what) const;
  void act();
  void take_effect();
  void prepare(Trouble trouble);
  void set_powers();
  void set_late_drivers();
  [[nodiscard]] const Fault* striking(Trouble trouble, std::size_t module) const;
  [[nodiscard]] const Fault* striking_the_line(Trouble trouble) const;
  [[nodiscard]] bool struck_by(Trouble trouble, std::size_t module) const {
    return striking(trouble, module) != nullptr;
  }
  [[nodiscard]] double rate_of(Trouble trouble) const;
  void set_noise();
  void set_echo();
  void say_foreign(const std::vector<std::uint8_t>& bytes);

  Bus& bus_;
  const Master& master_;
  Modules& modules_;
  Notice notice_;
  Chance chance_;
  std::vector<Armed> armed_;
  std::vector<std::uint64_t> replies_;  ///< that each module has begun
  std::size_t numbers_ = 0;
  bool changed_ = false;  ///< effects are to be set anew, as soon as no module is in the middle of something
  std::vector<std::size_t> hanging_;
  std::vector<std::vector<std::uint8_t>> to_say_;
  // On the line only where they are needed.
  std::unique_ptr<Noise> noise_;
  std::unique_ptr<Echo> echo_;
  std::unique_ptr<Master> stranger_;
};

}  // namespace ex9000::sim
