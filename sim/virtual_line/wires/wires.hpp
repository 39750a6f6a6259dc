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

/// A byte that a station sends.
struct Character {
  std::uint8_t byte;
  SerialMode mode;
  bool wrong_parity = false;  ///< if the format has a parity bit
};

/// A user of the wires. Some stations are devices on the two wires, for example a module or a master. Other
/// stations do not send or receive; Wires only calls their `run`.
class Station {
 public:
  /// Wires calls this at the time that the station has set with WireEnd::run_at. Before the call, Wires
  /// clears that time.
  virtual void run() = 0;
  /// Wires calls this for each byte of WireEnd::send, at the start of the byte, and at the end of the last
  /// one, when the result must be empty.
  virtual std::optional<Character> next_byte() { return std::nullopt; }
  /// Wires calls this after the first stop bit of a byte, if the station listens; `status` says whether the
  /// byte has an error. A station also receives its own bytes, because both directions share the two wires.
  virtual void receive(std::uint8_t /*byte*/, ByteStatus /*status*/) {}
  /// Returns how the station hears, if it can share an ear now, because it is at rest between two frames.
  [[nodiscard]] virtual std::optional<Hearing> hearing() const { return std::nullopt; }
  /// The station has shared an ear until now: brings it into the state in which it would be without that.
  virtual void catch_up(const Heard& /*missed*/) {}

 protected:
  ~Station() = default;
};

/// A station's end of the wires.
class WireEnd {
 public:
  /// Enables or disables the station's driver. Disabling it ends `send` and cuts off the byte on the wires.
  virtual void drive(bool on) = 0;
  /// Begins to send the bytes of Station::next_byte without gaps; the first start bit begins now.
  virtual void send() = 0;
  /// Sends one byte from now on.
  virtual void put(Character sent) = 0;
  /// Returns how long `bytes` bytes take if there is no gap between them.
  [[nodiscard]] virtual VirtualTime takes(std::size_t bytes, SerialMode mode) const = 0;
  /// Makes the station receive in this mode from now on; a rate of 0: the station does not listen. A receiver
  /// that begins in the middle of a byte samples the rest of it.
  virtual void listen(SerialMode mode) = 0;
  /// Sets the time of the station's next `run`, in place of an earlier setting; kNever: Wires does not call
  /// `run`.
  virtual void run_at(VirtualTime when) = 0;
  /// Ends the sharing of an ear. Call this before the station changes in a way that concerns its hearing.
  virtual void hear_alone() = 0;

 protected:
  ~WireEnd() = default;
};

/// Wires notifies observers of events on the wires.
class WireObserver {
 public:
  /// Called after the driver of `station` is enabled or disabled. `station` counts from 0 in the order of
  /// attachment.
  virtual void driver(std::size_t /*station*/, bool /*on*/, VirtualTime /*now*/) {}
  /// Called when `station` begins to send a byte and receivers get the levels `arrives` instead of the
  /// correct levels of the byte: the byte has wrong parity, or the disturbance has changed it.
  virtual void changed(std::size_t /*station*/, Levels /*arrives*/) {}
  /// Called at the end of the first stop bit of a byte that began at `start` and whose last stop bit ends at
  /// `end`. Not called if the driver of `station` was disabled before the end of this stop bit. `byte` is the
  /// byte that was sent. `collided`: during this byte, at least two drivers were enabled, or another byte was
  /// on the wires.
  virtual void byte(std::size_t station, std::uint8_t byte, SerialMode mode, bool collided, VirtualTime start,
                    VirtualTime end) = 0;

 protected:
  ~WireObserver() = default;
};

/// Changes the bytes that the receivers get, as noise does.
class Disturbance {
 public:
  struct Sent {
    Levels levels;
    SerialMode mode;
    VirtualTime ends;  ///< the end of the first stop bit
    bool contended;    ///< at least two drivers are enabled
  };
  /// Returns the levels that all receivers get instead of those of `sent`.
  virtual Levels disturbed(const Sent& sent) = 0;

 protected:
  ~Disturbance() = default;
};

/// A half-duplex line. A byte lasts ten or eleven bit times at the rate of its sender. A receiver with the
/// same rate and parity gets the byte unchanged after its first stop bit, if the byte has its correct levels
/// and does not collide. Otherwise the receiver samples the levels on the wires in its own mode, and may get
/// framing errors, parity errors, breaks or wrong bytes. If several stations send at the same time, the level
/// of the line is 0 while at least one of them sends a 0.
///
/// `times_faster` multiplies all nominal rates of the line, up to 500 Mbit/s on the wires. Below this limit,
/// the factor does not change which stations understand each other.
class Wires {
 public:
  /// An ear for fewer than these costs more than it saves.
  static constexpr std::size_t kFewestToShare = 3;

  /// `fewest_to_share`: at least this number of stations share an ear; the number makes no difference that
  /// stations or observers can notice.
  explicit Wires(VirtualClock& clock, std::uint32_t times_faster = 1,
                 std::size_t fewest_to_share = kFewestToShare);
  Wires(const Wires&) = delete;
  Wires& operator=(const Wires&) = delete;
  ~Wires();

  /// Adds a station, which does not listen yet. `station` must live as long as Wires is used. The returned
  /// end of the wires is valid until Wires is destroyed.
  WireEnd& attach(Station& station);
  /// Adds an observer. `observer` must live as long as Wires is used.
  void observe(WireObserver& observer) { observers_.push_back(&observer); }
  /// Lets `disturbance` change the bytes that are sent from now on, in place of an earlier disturbance.
  /// `disturbance` must live as long as Wires is used.
  void disturb(Disturbance& disturbance) { disturbance_ = &disturbance; }

  /// Returns the time of the next event of Wires or of a station; kNever if there is none.
  [[nodiscard]] VirtualTime next() const {
    return std::min(std::min(next_wire_event(), next_start_), std::min(next_silence_, due_times_.next()));
  }
  /// Sets the clock to the time `next`, unless the clock is already later. Then processes all events that are
  /// due, and further bytes that end not after `until` and before all other events. `next` must not be
  /// kNever.
  void run_next(VirtualTime until = kNever);
  /// Processes all events up to and including the time `until`. Then sets the clock to `until`, unless the
  /// clock is already later.
  void run_until(VirtualTime until);
  void run_for(VirtualTime duration) { run_until(clock_.virtual_now() + duration); }

  /// Returns whether at least one byte is on the wires.
  [[nodiscard]] bool carries() const { return carried_ != 0; }
  /// Returns whether a byte is on the wires or a driver is enabled.
  [[nodiscard]] bool busy() const { return carries() || drivers_on_ != 0; }
  /// Returns whether a shared ear waits for the end of a silence.
  [[nodiscard]] bool waits_for_silence() const { return next_silence_ != kNever; }
  /// Returns whether all stations that listen have the rate and the parity of `mode`.
  [[nodiscard]] bool all_hear(SerialMode mode) const { return !has_other_listeners(on_the_wires(mode)); }
  VirtualClock& clock() { return clock_; }

 private:
  struct End;
  struct Group;

  /// The receiver of a station.
  struct Receiver {
    Station* station = nullptr;
    SerialMode mode = {};  ///< on the wires; a rate of 0: the station does not listen
    bool samples = false;  ///< samples the wires, because it cannot get every byte unchanged
    UartSampler sampler = {};
    Group* group = nullptr;  ///< whose ear hears for the station; null: the station hears alone
  };

  /// Stations that share an ear, because they have heard the same since they began to listen.
  struct Group {
    Group(const VirtualClock& clock, const Hearing& hearing, SharedEar::Leave leave)
        : ear(clock, hearing, std::move(leave)) {}

    Receiver receiver;  ///< `mode` and `sampler` of the members
    SharedEar ear;
  };

  [[nodiscard]] std::uint32_t bit_rate(std::uint32_t baud) const;
  [[nodiscard]] SerialMode on_the_wires(SerialMode mode) const;
  [[nodiscard]] VirtualTime next_wire_event() const { return std::min(next_byte_end_, next_sample_); }
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
