// The virtual RS-485 line: any number of stations on two wires, in virtual time.
#pragma once

#include <algorithm>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <utility>
#include <vector>

#include "firmware/line/verdict.hpp"
#include "hal/doubles/virtual_clock.hpp"
#include "hal/serial_mode.hpp"
#include "sim/virtual_line/wires/due_times.hpp"
#include "sim/virtual_line/wires/shared_ear.hpp"
#include "sim/virtual_line/wires/uart_sampler.hpp"

namespace ex9000::sim {

using hal::SerialMode;
using hal::doubles::VirtualClock;

struct Character {
  std::uint8_t byte;
  SerialMode mode;
  bool wrong_parity = false;  ///< if the format has a parity bit
};

/// A device on the wires, for example a module, or one that only wants its `run` called.
class Station {
 public:
  /// At the time that WireEnd::run_at has set, which is cleared first.
  virtual void run() = 0;
  /// For WireEnd::send: at the start of each byte, and at the end of the last, when it must be empty.
  virtual std::optional<Character> next_byte() { return std::nullopt; }
  /// After the first stop bit, if the station listens. Also its own bytes: both directions share the wires.
  virtual void receive(std::uint8_t /*byte*/, ByteStatus /*status*/) {}
  /// How the station hears, if it can share an ear now: it rests between two frames.
  [[nodiscard]] virtual std::optional<Hearing> hearing() const { return std::nullopt; }
  /// Ends sharing an ear: brings the station into the state that it would have without that.
  virtual void catch_up(const Heard& /*missed*/) {}

 protected:
  ~Station() = default;
};

class WireEnd {
 public:
  /// Disabling the driver ends `send` and cuts off the byte on the wires.
  virtual void drive(bool on) = 0;
  /// Sends the bytes of Station::next_byte without gaps, from now on.
  virtual void send() = 0;
  /// Sends one byte from now on.
  virtual void put(Character sent) = 0;
  /// Without gaps.
  [[nodiscard]] virtual VirtualTime takes(std::size_t bytes, SerialMode mode) const = 0;
  /// A rate of 0: not at all. Inside a byte, the receiver samples the rest of it.
  virtual void listen(SerialMode mode) = 0;
  /// Replaces the time of the next `run`; kNever: none.
  virtual void run_at(VirtualTime when) = 0;
  /// A byte on the wires is 0 now.
  [[nodiscard]] virtual bool low() const = 0;
  /// Ends sharing an ear. Before any change that concerns the station's hearing.
  virtual void hear_alone() = 0;

 protected:
  ~WireEnd() = default;
};

class WireObserver {
 public:
  /// `station` counts from 0 in the order of attachment.
  virtual void driver(std::size_t /*station*/, bool /*on*/, VirtualTime /*now*/) {}
  /// A byte begins and receivers get `arrives`, not its correct levels: wrong parity, or a disturbance.
  virtual void changed(std::size_t /*station*/, Levels /*arrives*/) {}
  /// At the end of the first stop bit, unless the driver was disabled before; `end` is that of the last stop
  /// bit. `byte`: as sent. `collided`: another driver was enabled or another byte on the wires.
  virtual void byte(std::size_t station, std::uint8_t byte, SerialMode mode, bool collided, VirtualTime start,
                    VirtualTime end) = 0;

 protected:
  ~WireObserver() = default;
};

/// Changes what receivers get, as noise does.
class Disturbance {
 public:
  struct Sent {
    Levels levels;
    SerialMode mode;
    VirtualTime ends;  ///< the end of the first stop bit
    bool contended;    ///< at least two drivers are enabled
  };
  /// The levels that all receivers get.
  virtual Levels disturbed(const Sent& sent) = 0;

 protected:
  ~Disturbance() = default;
};

/// A half-duplex line. A byte lasts ten or eleven bit times of its sender. A receiver with the same rate and
/// parity gets it unchanged after its first stop bit, if it has its correct levels and does not collide. Else
/// the receiver samples the wires in its own mode, and may get framing errors, parity errors, breaks or wrong
/// bytes. The line is 0 while at least one sender sends a 0.
///
/// `times_faster` multiplies all nominal rates, up to 500 Mbit/s on the wires; below that, it does not change
/// which stations understand each other.
class Wires {
 public:
  /// An ear for fewer costs more than it saves.
  static constexpr std::size_t kFewestToShare = 3;

  /// At least `fewest_to_share` stations share an ear. Neither stations nor observers can notice the number.
  explicit Wires(VirtualClock& clock, std::uint32_t times_faster = 1,
                 std::size_t fewest_to_share = kFewestToShare);
  Wires(const Wires&) = delete;
  Wires& operator=(const Wires&) = delete;
  ~Wires();

  /// It does not listen yet. Whatever is attached, observes or disturbs must live as long as Wires is used.
  WireEnd& attach(Station& station);
  void observe(WireObserver& observer) { observers_.push_back(&observer); }
  /// Replaces the earlier one, for bytes sent from now on.
  void disturb(Disturbance& disturbance) { disturbance_ = &disturbance; }

  /// kNever: no event.
  [[nodiscard]] VirtualTime next() const {
    return std::min(std::min(next_wire_event(), next_start_), std::min(next_silence_, due_times_.next()));
  }
  /// Moves the clock to `next`, never back; processes what is due then, and bytes that end by `until` and
  /// before all other events. `next` must not be kNever.
  void run_next(VirtualTime until = kNever);
  /// Processes all events up to and including `until`, and moves the clock there, never back.
  void run_until(VirtualTime until);
  void run_for(VirtualTime duration) { run_until(clock_.virtual_now() + duration); }

  [[nodiscard]] bool carries() const { return carried_ != 0; }
  [[nodiscard]] bool busy() const { return carries() || drivers_on_ != 0; }
  [[nodiscard]] bool waits_for_silence() const { return next_silence_ != kNever; }
  [[nodiscard]] bool all_hear(SerialMode mode) const { return !has_other_listeners(on_the_wires(mode)); }
  VirtualClock& clock() { return clock_; }

 private:
  struct End;
  struct Group;

  struct Receiver {
    Station* station = nullptr;
    SerialMode mode = {};  ///< on the wires; a rate of 0: the station does not listen
    bool samples = false;  ///< samples the wires, because it cannot get every byte unchanged
    UartSampler sampler = {};
    Group* group = nullptr;  ///< whose ear hears for the station; null: the station hears alone
  };

  /// They have heard the same since they began to listen.
  struct Group {
    Group(const VirtualClock& clock, const Hearing& hearing, SharedEar::Leave leave)
        : ear(clock, hearing, std::move(leave)) {}

    Receiver receiver;  ///< `mode` and `sampler` of the members
    SharedEar ear;
  };

  [[nodiscard]] std::uint32_t bit_rate(std::uint32_t baud) const;
  [[nodiscard]] SerialMode on_the_wires(SerialMode mode) const;
  [[nodiscard]] VirtualTime next_wire_event() const { return std::min(next_byte_end_, next_sample_); }
  [[nodiscard]] bool low() const;
  static bool goes_on_without(Wave& wave, std::size_t station);
  void drive(End& end, bool on);
  void send(End& end);
  void stop_sending(const End& end);
  void start_bytes(VirtualTime until);
  void note_starts();
  [[nodiscard]] Wave wave_of(const End& end, const Character& sent);
  void carry(const Wave& wave);
  void listen(End& end, SerialMode mode);
  static bool has_heard_from_the_start(const Receiver& receiver, const Wave& wave);
  [[nodiscard]] bool has_to_sample(const Receiver& receiver) const;
  void count_listener(SerialMode mode, int change);
  [[nodiscard]] bool has_other_listeners(SerialMode mode) const;
  void begin_sampling();
  void end_sampling();
  void run_wire();
  void run_samplers();
  void finish_bytes();
  void deliver(const Wave& over);
  void forget_waves();
  void share(const Wave& first);
  Group& group_for(const Hearing& hearing, const Receiver& receiver);
  void hear_alone(std::size_t station);
  void add_alone(std::size_t station);
  void end_silences();
  void note_silences();

  VirtualClock& clock_;
  std::uint32_t times_faster_;
  std::size_t fewest_to_share_;
  std::vector<std::unique_ptr<End>> ends_;  ///< one for each station
  std::vector<Receiver> receivers_;         ///< one for each station
  std::vector<std::unique_ptr<Group>> groups_;
  std::vector<std::size_t> alone_;      ///< the stations that hear alone, in ascending order
  std::vector<std::size_t> now_alone_;  ///< those that `alone_` gets after a delivery
  bool delivers_ = false;
  VirtualTime quiet_since_{0};       ///< the end of the last byte
  std::vector<End*> sending_;        ///< in the order in which they began
  VirtualTime next_start_ = kNever;  ///< of a byte of `sending_`
  DueTimes due_times_;
  std::vector<WireObserver*> observers_;
  Disturbance* disturbance_ = nullptr;
  Waves waves_;           ///< the bytes on the wires, and older ones that samplers may still read
  unsigned carried_ = 0;  ///< number of bytes on the wires
  unsigned drivers_on_ = 0;
  std::map<std::pair<std::uint32_t, LineFormat>, int> listeners_;  ///< number of receivers for each mode
  VirtualTime next_byte_end_ = kNever;
  VirtualTime next_sample_ = kNever;   ///< not kNever while a receiver samples
  VirtualTime next_silence_ = kNever;  ///< not kNever while a shared ear waits for a silence
};

}  // namespace ex9000::sim
