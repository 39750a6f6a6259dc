#include "sim/bus/bus.hpp"

#include <algorithm>

namespace ex9000::sim {

/// The connection of one station to the wires.
struct Bus::End final : Wire {
  End(Bus& its_bus, Station& its_station, std::size_t its_index)
      : bus(its_bus), station(its_station), index(its_index) {}

  void drive(bool on) override { bus.drive(*this, on); }
  void put(std::uint8_t byte, std::uint32_t baud) override { bus.put(*this, byte, baud); }
  [[nodiscard]] VirtualTime takes(std::size_t bytes, std::uint32_t baud) const override {
    constexpr std::int64_t kBitNanoseconds = 1'000'000'000;
    return VirtualTime(static_cast<std::int64_t>(bytes * Wave::kBits) * kBitNanoseconds / bus.bit_rate(baud));
  }

  Bus& bus;
  Station& station;
  std::size_t index;
  bool driving = false;
  std::uint32_t bit_rate = 0;  ///< the rate of the sampler; 0: the station does not listen
  UartSampler sampler;
};

Bus::Bus(VirtualClock& clock, std::uint32_t times_faster) : clock_(clock), times_faster_(times_faster) {}

Bus::~Bus() = default;

/// Limits the rate, because samplers only make progress if half a bit lasts at least a nanosecond. No module
/// reaches this limit.
std::uint32_t Bus::bit_rate(std::uint32_t baud) const {
  constexpr std::uint64_t kFastest = 500'000'000;
  return static_cast<std::uint32_t>(std::min(std::uint64_t{baud} * times_faster_, kFastest));
}

Wire& Bus::attach(Station& station) {
  ends_.push_back(std::make_unique<End>(*this, station, ends_.size()));
  return *ends_.back();
}

VirtualTime Bus::next() const {
  VirtualTime next = next_sample_;
  for (const Byte& byte : on_the_wire_) {
    next = std::min(next, byte.wave.end());
  }
  for (const auto& end : ends_) {
    next = std::min(next, end->station.next());
  }
  return next;
}

void Bus::run_until(VirtualTime until) {
  for (VirtualTime now = next(); now <= until; now = next()) {
    clock_.set(std::max(now, clock_.virtual_now()));
    run_wire();
    for (const auto& end : ends_) {
      if (end->station.next() <= clock_.virtual_now()) {
        end->station.run();
      }
    }
  }
  clock_.set(std::max(until, clock_.virtual_now()));
}

void Bus::drive(End& end, bool on) {
  if (end.driving == on) {
    return;
  }
  end.driving = on;
  drivers_on_ += on ? 1U : -1U;
  const VirtualTime now = clock_.virtual_now();
  if (drivers_on_ > 1) {
    for (Byte& byte : on_the_wire_) {
      byte.collided = true;
    }
  }
  if (!on) {
    // The byte in progress ends here. The rest of it is the idle level, which each receiver interprets.
    for (Byte& byte : on_the_wire_) {
      if (byte.station == end.index && byte.wave.end() > now) {
        byte.collided = byte.cut_off = true;
        byte.wave.cut_off = now;
        std::find_if(waves_.rbegin(), waves_.rend(), [&](const Wave& wave) {
          return wave.start == byte.wave.start && wave.levels == byte.wave.levels;
        })->cut_off = now;
      }
    }
  }
  for (BusObserver* observer : observers_) {
    observer->driver(end.index, on, now);
  }
}

void Bus::put(End& end, std::uint8_t byte, std::uint32_t baud) {
  Wave wave{clock_.virtual_now(), bit_rate(baud), levels_of(byte)};
  if (disturbance_ != nullptr) {
    wave.levels = disturbance_->disturbed({wave.levels, baud, wave.end(), drivers_on_ > 1});
    for (BusObserver* observer : observers_) {
      if (wave.levels != levels_of(byte)) {
        observer->changed(end.index, wave.levels);
      }
    }
  }
  const bool collided = drivers_on_ > 1 || !on_the_wire_.empty();
  for (Byte& other : on_the_wire_) {
    other.collided = true;
  }
  on_the_wire_.push_back({end.index, byte, collided, false, baud, wave});
  waves_.push_back(wave);
  run_wire();
}

/// A receiver that was off or has changed its rate starts now, even in the middle of a byte.
void Bus::take_rate(End& end) {
  const std::uint32_t rate = bit_rate(end.station.baud());
  if (rate != end.bit_rate) {
    end.bit_rate = rate;
    end.sampler = UartSampler();
    end.sampler.skip_to(clock_.virtual_now());
  }
}

/// Whether a receiver has to sample the wave instead of receiving whole bytes.
bool Bus::samples(const End& end) const {
  if (end.bit_rate == 0) {
    return false;
  }
  return end.sampler.busy() || std::any_of(on_the_wire_.begin(), on_the_wire_.end(), [&](const Byte& byte) {
           return !byte.arrives_whole() || byte.wave.baud != end.bit_rate ||
                  end.sampler.position() > byte.wave.start;
         });
}

void Bus::sample(End& end) {
  while (const auto received = end.sampler.advance(waves_, end.bit_rate, clock_.virtual_now())) {
    end.station.receive(received->byte, received->status);
  }
}

void Bus::run_wire() {
  const VirtualTime now = clock_.virtual_now();
  for (const auto& end : ends_) {
    take_rate(*end);
    if (samples(*end)) {
      sample(*end);
    }
  }
  for (std::size_t i = 0; i < on_the_wire_.size();) {
    if (on_the_wire_[i].wave.end() > now) {
      ++i;
      continue;
    }
    const Byte over = on_the_wire_[i];
    on_the_wire_.erase(on_the_wire_.begin() + static_cast<std::ptrdiff_t>(i));
    if (over.cut_off) {
      continue;
    }
    for (BusObserver* observer : observers_) {
      observer->byte(over.station, over.byte, over.baud, over.collided, over.wave.start, now);
    }
    for (const auto& end : ends_) {
      const bool whole =
          over.arrives_whole() && !end->sampler.busy() && end->sampler.position() <= over.wave.start;
      if (whole && end->bit_rate == over.wave.baud) {
        end->sampler.skip_to(now);
        end->station.receive(over.byte, ByteStatus::Good);
      }
    }
  }
  // A sampler runs every half bit, which is often enough to deliver its bytes in time.
  next_sample_ = kNever;
  for (const auto& end : ends_) {
    if (samples(*end)) {
      next_sample_ = std::min(next_sample_, now + VirtualTime(500'000'000 / end->bit_rate));
    }
  }
  forget_waves();
}

void Bus::forget_waves() {
  while (!waves_.empty() && waves_.front().end() <= clock_.virtual_now()) {
    const bool needed = std::any_of(ends_.begin(), ends_.end(), [this](const auto& end) {
      return end->bit_rate != 0 && end->sampler.busy() && end->sampler.position() < waves_.front().end();
    });
    if (needed) {
      return;
    }
    waves_.pop_front();
  }
}

}  // namespace ex9000::sim
