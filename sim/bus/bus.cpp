#include "sim/bus/bus.hpp"

#include <algorithm>

namespace ex9000::sim {

struct Bus::End final : BusEnd {
  End(Bus& its_bus, Station& its_station, std::size_t its_index)
      : bus(its_bus), station(its_station), index(its_index) {}

  void drive(bool on) override { bus.drive(*this, on); }
  void put(std::uint8_t byte, std::uint32_t baud) override { bus.put(*this, byte, baud); }
  [[nodiscard]] VirtualTime takes(std::size_t bytes, std::uint32_t baud) const override {
    constexpr std::int64_t kBitNanoseconds = 1'000'000'000;
    return VirtualTime(static_cast<std::int64_t>(bytes * Wave::kBits) * kBitNanoseconds / bus.bit_rate(baud));
  }
  void listen(std::uint32_t baud) override { bus.listen(*this, baud); }
  void run_at(VirtualTime when) override { bus.due_times_.set(index, when); }

  Bus& bus;
  Station& station;
  std::size_t index;
  bool driving = false;
  std::uint32_t bit_rate = 0;  ///< of the receiver; 0: the station does not listen
  bool samples = false;        ///< the receiver samples the wires instead of getting whole bytes
  UartSampler sampler;
};

Bus::Bus(VirtualClock& clock, std::uint32_t times_faster) : clock_(clock), times_faster_(times_faster) {}

Bus::~Bus() = default;

/// Returns the real bit rate. It is limited, because samplers only make progress if half a bit lasts at least
/// a nanosecond. No module reaches this limit.
std::uint32_t Bus::bit_rate(std::uint32_t baud) const {
  constexpr std::uint64_t kFastest = 500'000'000;
  return static_cast<std::uint32_t>(std::min(std::uint64_t{baud} * times_faster_, kFastest));
}

BusEnd& Bus::attach(Station& station) {
  ends_.push_back(std::make_unique<End>(*this, station, due_times_.add()));
  return *ends_.back();
}

VirtualTime Bus::next() const { return std::min({next_byte_end_, next_sample_, due_times_.next()}); }

void Bus::run_until(VirtualTime until) {
  for (VirtualTime now = next(); now <= until; now = next()) {
    clock_.set(std::max(now, clock_.virtual_now()));
    run_wire();
    while (const auto station = due_times_.take(clock_.virtual_now())) {
      ends_[*station]->station.run();
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
  for (Byte& byte : on_the_wire_) {
    byte.collided = byte.collided || drivers_on_ > 1;
    if (!on && byte.station == end.index && byte.wave->end() > now) {
      // The sender leaves the line idle for the rest of the byte, and the receivers sample the result.
      byte.collided = true;
      byte.wave->cut_off = now;
    }
  }
  begin_sampling();
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
  const bool collides = drivers_on_ > 1 || !on_the_wire_.empty();
  for (Byte& other : on_the_wire_) {
    other.collided = true;
  }
  waves_.push_back(wave);
  on_the_wire_.push_back({end.index, byte, collides, baud, &waves_.back()});
  next_byte_end_ = std::min(next_byte_end_, wave.end());
  if (!on_the_wire_.back().arrives_whole() || has_listeners_at_other_rates(wave.baud)) {
    begin_sampling();
  }
}

void Bus::listen(End& end, std::uint32_t baud) {
  const std::uint32_t rate = bit_rate(baud);
  if (rate == end.bit_rate) {
    return;
  }
  count_listener(end.bit_rate, -1);
  count_listener(rate, 1);
  end.bit_rate = rate;
  sampling_ -= end.samples ? 1U : 0U;
  end.samples = false;
  end.sampler = UartSampler();
  end.sampler.skip_to(clock_.virtual_now());
  begin_sampling();
}

void Bus::count_listener(std::uint32_t rate, int change) {
  if (rate != 0 && (listeners_[rate] += change) == 0) {
    listeners_.erase(rate);
  }
}

bool Bus::has_listeners_at_other_rates(std::uint32_t rate) const {
  return listeners_.size() > 1 || (listeners_.size() == 1 && listeners_.begin()->first != rate);
}

/// Returns whether the receiver has the rate of the byte and has listened since its start.
bool Bus::has_heard_from_the_start(const End& end, const Wave& wave) {
  return wave.baud == end.bit_rate && end.sampler.position() <= wave.start;
}

bool Bus::has_to_sample(const End& end) const {
  const auto gets_whole = [&](const Byte& byte) {
    return byte.arrives_whole() && has_heard_from_the_start(end, *byte.wave);
  };
  return end.bit_rate != 0 &&
         (end.sampler.busy() || !std::all_of(on_the_wire_.begin(), on_the_wire_.end(), gets_whole));
}

/// Starts to sample for each receiver that cannot get every byte on the wires as a whole byte.
void Bus::begin_sampling() {
  for (const auto& end : ends_) {
    if (!end->samples && has_to_sample(*end)) {
      end->samples = true;
      ++sampling_;
      // Before the first of these bytes began, the line was idle or the receiver got whole bytes.
      end->sampler.skip_to(std::max(end->sampler.position(), on_the_wire_.front().wave->start));
      next_sample_ = std::min(next_sample_, end->sampler.next(end->bit_rate, clock_.virtual_now()));
    }
  }
}

void Bus::end_sampling() {
  next_sample_ = kNever;
  for (const auto& end : ends_) {
    if (end->samples && !has_to_sample(*end)) {
      end->samples = false;
      --sampling_;
    }
    if (end->samples) {
      next_sample_ = std::min(next_sample_, end->sampler.next(end->bit_rate, clock_.virtual_now()));
    }
  }
}

void Bus::run_wire() {
  if (std::min(next_byte_end_, next_sample_) > clock_.virtual_now()) {
    return;
  }
  if (sampling_ != 0) {
    run_samplers();
  }
  finish_bytes();
  if (next_sample_ != kNever) {
    end_sampling();
  }
  forget_waves();
}

void Bus::run_samplers() {
  for (const auto& end : ends_) {
    while (end->samples) {
      const auto received = end->sampler.advance(waves_, end->bit_rate, clock_.virtual_now());
      if (!received) {
        break;
      }
      end->station.receive(received->byte, received->status);
    }
  }
}

/// Removes the bytes that have ended from the wires, and delivers those that were not cut off.
void Bus::finish_bytes() {
  const VirtualTime now = clock_.virtual_now();
  for (std::size_t i = 0; i < on_the_wire_.size();) {
    if (on_the_wire_[i].wave->end() > now) {
      ++i;
      continue;
    }
    const Byte over = on_the_wire_[i];
    on_the_wire_.erase(on_the_wire_.begin() + static_cast<std::ptrdiff_t>(i));
    if (over.wave->cut_off == kNever) {
      deliver(over);
    }
  }
  next_byte_end_ = kNever;
  for (const Byte& byte : on_the_wire_) {
    next_byte_end_ = std::min(next_byte_end_, byte.wave->end());
  }
}

void Bus::deliver(const Byte& over) {
  for (BusObserver* observer : observers_) {
    observer->byte(over.station, over.byte, over.baud, over.collided, over.wave->start, clock_.virtual_now());
  }
  if (!over.arrives_whole()) {
    return;
  }
  for (const auto& end : ends_) {
    if (!end->samples && has_heard_from_the_start(*end, *over.wave)) {
      end->station.receive(over.byte, ByteStatus::Good);
    }
  }
}

void Bus::forget_waves() {
  while (!waves_.empty() && waves_.front().end() <= clock_.virtual_now()) {
    const bool needed = sampling_ != 0 && std::any_of(ends_.begin(), ends_.end(), [this](const auto& end) {
                          return end->samples && end->sampler.position() < waves_.front().end();
                        });
    if (needed) {
      return;
    }
    waves_.pop_front();
  }
}

}  // namespace ex9000::sim
