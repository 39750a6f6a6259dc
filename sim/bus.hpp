// The virtual RS-485 line: any number of stations on two wires, in virtual time.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <vector>

#include "firmware/line/verdict.hpp"
#include "hal/doubles/serial_line.hpp"
#include "hal/doubles/virtual_clock.hpp"
#include "sim/uart_sampler.hpp"

namespace ex9000::sim {

using hal::doubles::kNever;
using hal::doubles::VirtualClock;
using hal::doubles::VirtualTime;
using hal::doubles::Wire;

/// Something on the two wires: a module, or a master.
class Station {
 public:
  /// When `run` has something to do; kNever: only when a byte comes.
  [[nodiscard]] virtual VirtualTime next() const = 0;
  /// The clock shows a time at or behind `next()`.
  virtual void run() = 0;
  /// Bits per second its receiver listens at; 0: it does not listen.
  [[nodiscard]] virtual std::uint32_t baud() const = 0;
  /// The stop bit of a byte has passed; its own bytes come back too, as on two wires.
  virtual void receive(std::uint8_t byte, ByteStatus status) = 0;

 protected:
  ~Station() = default;
};

/// Sees all that happens on the wires.
class BusObserver {
 public:
  /// `station` counts from 0 in the order of attaching.
  virtual void driver(std::size_t station, bool on, VirtualTime now) = 0;
  /// The byte that `station` begins now is changed by the disturbance: receivers see `arrives` in its place.
  virtual void changed(std::size_t /*station*/, Levels /*arrives*/) {}
  /// A byte began at `start` and is over now, unless its driver went off before. `byte` is what was sent.
  /// `collided`: another was on meanwhile.
  virtual void byte(std::size_t station, std::uint8_t byte, std::uint32_t baud, bool collided,
                    VirtualTime start, VirtualTime end) = 0;

 protected:
  ~BusObserver() = default;
};

/// What becomes of a byte on its way: noise.
class Disturbance {
 public:
  struct Sent {
    Levels levels;
    std::uint32_t baud;
    VirtualTime ends;
    bool contended;  ///< another driver is on
  };
  /// What all receivers see in its place.
  virtual Levels disturbed(const Sent& sent) = 0;

 protected:
  ~Disturbance() = default;
};

/// Half duplex, 8N1. A byte takes ten bits at its sender's rate. A receiver of the same rate gets it when its
/// stop bit has passed; one of another rate samples the wave at its own and sees framing errors and garbage.
/// Where two drivers are on at once, a 0 of either wins, and what arrives is what that wave looks like.
///
/// The clock jumps from event to event; nothing here knows real time.
///
/// A line may be made so many times faster than its rates say: all rates of modules are multiplied alike, so
/// who understands whom, and what collides, stays the same.
class Bus {
 public:
  explicit Bus(VirtualClock& clock, std::uint32_t times_faster = 1);
  Bus(const Bus&) = delete;
  Bus& operator=(const Bus&) = delete;
  ~Bus();

  /// `station` and the returned end of the wires live as long as the bus is used.
  Wire& attach(Station& station);
  void observe(BusObserver& observer) { observers_.push_back(&observer); }
  /// From now on all that is sent goes through `disturbance`, which lives as long as the bus is used.
  void disturb(Disturbance& disturbance) { disturbance_ = &disturbance; }

  /// The next event of bus or stations.
  [[nodiscard]] VirtualTime next() const;
  /// Lets everything happen up to and including `until`; the clock shows it then.
  void run_until(VirtualTime until);
  void run_for(VirtualTime duration) { run_until(clock_.virtual_now() + duration); }

  /// A byte or more is under way.
  [[nodiscard]] bool carries() const { return !on_the_wire_.empty(); }
  /// Or a driver is on.
  [[nodiscard]] bool busy() const { return carries() || drivers_on_ != 0; }
  VirtualClock& clock() { return clock_; }

 private:
  struct End;

  [[nodiscard]] std::uint32_t bit_rate(std::uint32_t baud) const;
  void drive(End& end, bool on);
  void put(End& end, std::uint8_t byte, std::uint32_t baud);
  void sample(End& end);
  void take_rate(End& end);
  [[nodiscard]] bool samples(const End& end) const;
  void forget_waves();
  void run_wire();

  /// A byte that is being sent.
  struct Byte {
    std::size_t station = 0;
    std::uint8_t byte = 0;
    bool collided = false;
    bool cut_off = false;
    std::uint32_t baud = 0;  ///< as its sender has it; the wave has the bit rate
    Wave wave;

    /// Whether a receiver at its rate may be handed it as it was sent.
    [[nodiscard]] bool arrives_whole() const { return !collided && wave.levels == levels_of(byte); }
  };

  VirtualClock& clock_;
  std::uint32_t times_faster_;
  std::vector<std::unique_ptr<End>> ends_;
  std::vector<BusObserver*> observers_;
  Disturbance* disturbance_ = nullptr;
  std::vector<Byte> on_the_wire_;
  std::deque<Wave> waves_;  ///< what samplers may still look at
  unsigned drivers_on_ = 0;
  VirtualTime next_sample_ = kNever;
};

}  // namespace ex9000::sim
