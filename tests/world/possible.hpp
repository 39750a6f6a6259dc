// One state that a module may be in, as far as its wires and terminals tell.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tests/oracles/reference/module.hpp"

namespace ex9000::world {

using reference::Bytes;
using reference::Moment;
using reference::Time;

/// A frame that the module has received and not executed yet.
struct Waiting {
  Bytes bytes;
  std::vector<bool> bad;  ///< which bytes have a line error
  Time last{0};           ///< the end of its last stop bit
  Moment judged{};        ///< when the module can judge it
};

/// A reply that the module has to send.
struct Due {
  Bytes bytes;
  std::string refusal;  ///< why the request is refused, for people
  Moment begins{};
  bool takes_address = false;  ///< the request changes the address in force
};

/// Adds to the reference, which executes whole frames, what happens around that: bytes become frames, frames
/// wait, settings are stored, and each has its time. Something that happens at an unknown time is an event
/// with a window; `futures` returns the states after the events whose windows are open.
class Possible {
 public:
  explicit Possible(const reference::ModelRow& row) : module_(row), saved_(module_.stored()) {}

  // --- what happens to the module; before each, call `futures` with the same time ---

  void store(const reference::Stored& stored);
  /// After `off` or a reset, the memory has the content of one of the results.
  [[nodiscard]] std::vector<Possible> power_off() const;
  void power_on(Time now);
  [[nodiscard]] std::vector<Possible> reset(unsigned reason, Time now) const;
  /// `time` 0: until a reset.
  void hang(Time time, Time now);
  void tick_stops(Time now);
  void init(bool asserted, Time now);
  void memory_fails(bool fails, Time now);
  void slots_fail(bool fails, Time now);
  void start_bad_images(bool bad) { images_are_bad_ = bad; }
  void input(unsigned channel, bool level, Time now) { module_.set_input(channel, level, now); }
  void pulse(unsigned channel, std::uint32_t count, Time now) { module_.pulse_input(channel, count, now); }
  /// The module begins to listen, the last step of its start.
  [[nodiscard]] std::vector<Possible> listen(unsigned rate, LineFormat format, Time now) const;
  /// `end`: the end of the first stop bit.
  [[nodiscard]] std::vector<Possible> hear(std::uint8_t byte, bool good, Time end) const;

  // --- what the module does ---

  /// The module begins to reply. The result is empty if it must not send this reply now.
  [[nodiscard]] std::vector<Possible> reply(const Bytes& bytes, Time begins) const;
  void replied(Time end);

  /// Adds to `after` the states after each event that may have happened between `since` and `now`. Returns
  /// whether this state is still possible, because no event is overdue.
  bool futures(Time since, Time now, std::vector<Possible>& after) const;

  [[nodiscard]] const reference::Module& module() const { return module_; }
  reference::Module& module() { return module_; }
  [[nodiscard]] unsigned outputs() const { return start_ < Start::Driven ? 0 : module_.outputs(); }
  /// Returns whether a request without line errors would store settings.
  [[nodiscard]] bool would_store(const Bytes& request) const;
  /// The main loop does nothing.
  [[nodiscard]] bool hangs(Time now) const { return hung_ || now < hangs_until_; }
  /// Returns whether the LED may be dark.
  [[nodiscard]] bool may_be_dark() const {
    return !module_.powered() || start_ != Start::Over || module_.led_flashes() || unreadable_;
  }
  /// Return whether the LED may have been lit, or dark, since `since`.
  [[nodiscard]] bool may_be_lit(Time since, Time now) const;
  [[nodiscard]] bool may_be_dark(Time since, Time now) const;
  /// For people.
  [[nodiscard]] std::string text() const;

  /// Returns whether the states differ at most in times that are not exactly known.
  [[nodiscard]] bool is_like(const Possible& other) const;
  /// Makes the times cover those of a state that is like this one. Returns whether that changes any.
  bool widen(const Possible& other);

 private:
  [[nodiscard]] Time half_bits(unsigned count) const;
  [[nodiscard]] Time stop_bits_left() const;
  [[nodiscard]] Time gap() const;
  [[nodiscard]] bool is_whole() const;
  [[nodiscard]] std::vector<Possible> frame_ends(Moment received, Moment judged) const;
  [[nodiscard]] Time frame_limit() const;
  void save();
  [[nodiscard]] bool led_is_known(Time now) const;
  void come_up(Time since, Time now, std::vector<Possible>& after) const;
  void execute(Time since, Time now, std::vector<Possible>& after) const;
  [[nodiscard]] bool first_stores() const;
  [[nodiscard]] Time first_judged_by() const;
  [[nodiscard]] Time first_takes() const;
  [[nodiscard]] Time first_by(Time takes) const;
  [[nodiscard]] std::vector<reference::Stored> may_be_stored() const;
  [[nodiscard]] std::vector<reference::Update> after_reset() const;
  [[nodiscard]] bool activates() const;
  void update(Time since, Time now, std::vector<Possible>& after, bool& stays) const;

  reference::Module module_;
  enum class Start { Begins, InputsCount, Driven, Over };
  Start start_ = Start::Over;
  Time reset_at_{0};  ///< the cause of the reset
  struct InitChange {
    bool asserted;
    Time when;
  };
  std::optional<InitChange> init_changes_;
  Time init_changed_ = Time::min();  ///< the last change at the terminal
  // The frame that is not over.
  Bytes open_;
  std::vector<bool> bad_;
  Time last_{0};           ///< the end of the first stop bit of its last byte
  bool skipping_ = false;  ///< ASCII: another module's reply
  std::vector<Waiting> waiting_;
  /// If the first one of `waiting_` was judged before the last timeout, the lasting outputs before that.
  std::optional<unsigned> overtaken_;
  reference::Stored overtaken_store_;  ///< and what it stores if its store began before that
  std::optional<Due> due_;
  bool sending_ = false;
  std::optional<Time> hung_;          ///< since when
  std::optional<Time> tick_stopped_;  ///< since when
  Time hangs_until_ = Time::min();    ///< by then, the main loop runs again
  Time replied_ = Time::min();        ///< the end of its last reply
  Time free_{0};                      ///< by then the module has nothing else to do
  reference::Stored saved_;
  std::vector<reference::Stored> older_;   ///< may be in the other copy
  bool loads_older_ = false;               ///< the module could not read the newest copy
  bool unreadable_ = false;                ///< the module could not read its settings
  bool stores_again_ = false;              ///< a reset might not load the settings in force (wire.md 8)
  std::vector<reference::Stored> ghosts_;  ///< that an interrupted store may have left
  std::optional<Moment> timeout_unsaved_;  ///< the timeout that is not stored yet
  Time memory_fails_until_ = Time::min();
  Time flashes_since_{0};                        ///< if the LED flashes
  std::vector<reference::Update> before_begin_;  ///< what a begin whose erase may not be over may have left
  Time erases_until_ = Time::min();              ///< that erase
  Time slots_fail_until_ = Time::min();
  bool images_are_bad_ = false;
  std::optional<Time> activates_since_;  ///< the reply has left, and a reset follows
};

}  // namespace ex9000::world
