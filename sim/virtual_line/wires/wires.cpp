#include "sim/virtual_line/wires/wires.hpp"

#include <algorithm>

#include "firmware/expect.hpp"

namespace ex9000::sim {

struct Wires::End final : WireEnd {
  End(Wires& its_wires, std::size_t its_index) : wires(its_wires), index(its_index) {}

  void drive(bool on) override { wires.drive(*this, on); }
  void send() override { wires.send(*this); }
  void put(Character byte) override { wires.carry(wires.wave_of(*this, byte)); }
  [[nodiscard]] VirtualTime takes(std::size_t bytes, SerialMode mode) const override {
    constexpr std::int64_t kBitNanoseconds = 1'000'000'000;
    return VirtualTime(static_cast<std::int64_t>(bytes * bits_of_character(mode.format)) * kBitNanoseconds /
                       wires.bit_rate(mode.baud));
  }
  void listen(SerialMode mode) override { wires.listen(*this, mode); }
  [[nodiscard]] bool low() const override { return wires.low(); }
  void hear_alone() override { wires.hear_alone(index); }
  void run_at(VirtualTime when) override { wires.due_times_.set(index, when); }

  Wires& wires;
  std::size_t index;
  bool driving = false;
  /// `begun` bytes of `its_mode` after `since`, so that rounding errors do not add up.
  VirtualTime next_start = kNever;
  VirtualTime since{0};
  std::size_t begun = 0;
  SerialMode its_mode;
};

Wires::Wires(VirtualClock& clock, std::uint32_t times_faster, std::size_t fewest_to_share)
    : clock_(clock), times_faster_(times_faster), fewest_to_share_(fewest_to_share) {}

Wires::~Wires() = default;

/// At most 500 Mbit/s: with half a bit below 1 ns, a sampler makes no progress. No module gets there.
std::uint32_t Wires::bit_rate(std::uint32_t baud) const {
  constexpr std::uint64_t kFastest = 500'000'000;
  return static_cast<std::uint32_t>(std::min(std::uint64_t{baud} * times_faster_, kFastest));
}

/// A receiver gets a byte without sampling only if this is equal for it and for the sender.
SerialMode Wires::on_the_wires(SerialMode mode) const {
  return {bit_rate(mode.baud), as_received(mode.format)};
}

WireEnd& Wires::attach(Station& station) {
  alone_.push_back(receivers_.size());
  receivers_.push_back({&station});
  ends_.push_back(std::make_unique<End>(*this, due_times_.add()));
  return *ends_.back();
}

void Wires::run_next(VirtualTime until) {
  EX9000_EXPECT(next() != kNever);
  clock_.set(std::max(next(), clock_.virtual_now()));
  if (next_wire_event() <= clock_.virtual_now()) {
    run_wire();
  }
  start_bytes(until);
  const VirtualTime now = clock_.virtual_now();
  if (next_silence_ <= now) {
    end_silences();
  }
  if (due_times_.next() <= now) {
    due_times_.run_due(now, [this](std::size_t station) { receivers_[station].station->run(); });
  }
}

void Wires::run_until(VirtualTime until) {
  while (next() <= until) {
    run_next(until);
  }
  clock_.set(std::max(until, clock_.virtual_now()));
}

bool Wires::low() const {
  const VirtualTime now = clock_.virtual_now();
  return std::any_of(waves_.begin(), waves_.end(), [now](const Wave& wave) { return !wave.level(now); });
}

/// Other stations send the rest of the byte.
bool Wires::goes_on_without(Wave& wave, std::size_t station) {
  if (wave.also.empty()) {
    return false;
  }
  if (wave.station == station) {
    wave.station = wave.also.back();
    wave.also.pop_back();
    return true;
  }
  wave.also.erase(std::remove(wave.also.begin(), wave.also.end(), station), wave.also.end());
  return false;
}

void Wires::drive(End& end, bool on) {
  if (end.driving == on) {
    return;
  }
  end.driving = on;
  drivers_on_ += on ? 1U : -1U;
  EX9000_EXPECT(drivers_on_ <= ends_.size());
  const VirtualTime now = clock_.virtual_now();
  if (!on) {
    stop_sending(end);
  }
  for (Wave& wave : waves_) {
    wave.collided = wave.collided || drivers_on_ > 1;
    if (!on && wave.end > now && goes_on_without(wave, end.index)) {
      continue;
    }
    if (!on && wave.station == end.index && wave.cut_off == kNever && wave.end > now) {
      // The sender leaves the rest of the byte idle, and the receivers sample the result.
      wave.collided = true;
      wave.cut_off = now;
    }
  }
  begin_sampling();
  for (WireObserver* observer : observers_) {
    observer->driver(end.index, on, now);
  }
}

void Wires::send(End& end) {
  EX9000_EXPECT(end.driving);
  end.next_start = end.since = clock_.virtual_now();
  end.begun = 0;
  sending_.push_back(&end);
  note_starts();
}

void Wires::stop_sending(const End& end) {
  sending_.erase(std::remove(sending_.begin(), sending_.end(), &end), sending_.end());
  note_starts();
}

void Wires::note_starts() {
  next_start_ = kNever;
  for (const End* end : sending_) {
    next_start_ = std::min(next_start_, end->next_start);
  }
}

/// A byte that nothing can disturb arrives at once, with the clock at its end: no other byte is on the wires,
/// all stations hear it, and nothing else happens before it ends.
void Wires::start_bytes(VirtualTime until) {
  while (next_start_ <= clock_.virtual_now()) {
    std::size_t first = 0;
    while (sending_[first]->next_start != next_start_) {
      ++first;
    }
    End& end = *sending_[first];
    const std::optional<Character> sent = receivers_[end.index].station->next_byte();
    if (!sent) {
      stop_sending(end);
      continue;
    }
    if (sent->mode != end.its_mode) {
      end.its_mode = sent->mode;
      end.since = clock_.virtual_now();
      end.begun = 0;
    }
    end.next_start = end.since + end.takes(++end.begun, end.its_mode);
    note_starts();
    const Wave wave = wave_of(end, *sent);
    const VirtualTime others = std::min(next_silence_, due_times_.next());
    if (wave.arrives_whole() && !has_other_listeners(wave.mode) && next_sample_ == kNever &&
        wave.end <= std::min(until, others)) {
      clock_.set(wave.end);
      deliver(wave);
    } else {
      carry(wave);
    }
  }
}

Wave Wires::wave_of(const End& end, const Character& sent) {
  const auto [byte, mode, wrong_parity] = sent;
  const Levels right = levels_of(byte, mode.format);
  Wave wave{clock_.virtual_now(), on_the_wires(mode),
            wrong_parity ? with_wrong_parity(right, mode.format) : right};
  if (disturbance_ != nullptr) {
    wave.levels = disturbance_->disturbed({wave.levels, mode, wave.end, drivers_on_ > 1});
  }
  wave.disturbed = wave.levels != right;
  if (wave.disturbed) {
    for (WireObserver* observer : observers_) {
      observer->changed(end.index, wave.levels);
    }
  }
  wave.station = end.index;
  wave.nominal = mode;
  wave.byte = byte;
  wave.collided = drivers_on_ > 1 || carries();
  return wave;
}

void Wires::carry(const Wave& wave) {
  for (Wave& other : waves_) {
    other.collided = true;
    // In a window of an arbitration, hundreds of modules may send the same byte at the same time.
    if (other.start == wave.start && other.mode == wave.mode && other.levels == wave.levels && !other.over &&
        other.cut_off == kNever && other.nominal == wave.nominal && other.byte == wave.byte) {
      other.also.push_back(wave.station);
      return;
    }
  }
  waves_.push_back(wave);
  ++carried_;
  next_byte_end_ = std::min(next_byte_end_, wave.end);
  if (!wave.arrives_whole() || has_other_listeners(wave.mode)) {
    begin_sampling();
  }
}

void Wires::listen(End& end, SerialMode mode) {
  const SerialMode now = on_the_wires(mode);
  Receiver& receiver = receivers_[end.index];
  if (now == receiver.mode) {
    return;
  }
  hear_alone(end.index);
  count_listener(receiver.mode, -1);
  count_listener(now, 1);
  receiver.mode = now;
  receiver.samples = false;
  receiver.sampler = UartSampler();
  receiver.sampler.skip_to(clock_.virtual_now());
  begin_sampling();
}

void Wires::count_listener(SerialMode mode, int change) {
  const auto key = std::pair(mode.baud, mode.format);
  if (mode.baud != 0 && (listeners_[key] += change) == 0) {
    listeners_.erase(key);
  }
}

bool Wires::has_other_listeners(SerialMode mode) const {
  return listeners_.size() > 1 ||
         (listeners_.size() == 1 && listeners_.begin()->first != std::pair(mode.baud, mode.format));
}

/// Also false in another mode, or if the receiver has sampled a part of the byte.
bool Wires::has_heard_from_the_start(const Receiver& receiver, const Wave& wave) {
  return wave.mode == receiver.mode && receiver.sampler.position() <= wave.start;
}

bool Wires::has_to_sample(const Receiver& receiver) const {
  const auto gets_whole = [&](const Wave& wave) {
    return wave.over || (wave.arrives_whole() && has_heard_from_the_start(receiver, wave));
  };
  return receiver.mode.baud != 0 &&
         (receiver.sampler.busy() || !std::all_of(waves_.begin(), waves_.end(), gets_whole));
}

/// For receivers that cannot get every byte on the wires unchanged.
void Wires::begin_sampling() {
  const auto first = std::find_if(waves_.begin(), waves_.end(), [](const Wave& wave) { return !wave.over; });
  if (first == waves_.end()) {
    return;
  }
  for (const auto& group : groups_) {
    if (group->ear.members() != 0 && has_to_sample(group->receiver)) {
      group->ear.dissolve();
    }
  }
  for (Receiver& receiver : receivers_) {
    if (receiver.group == nullptr && !receiver.samples && has_to_sample(receiver)) {
      receiver.samples = true;
      // From the first byte that has not ended, or from its own position if later: the receiver got older
      // bytes unchanged, has sampled them, or did not listen.
      receiver.sampler.skip_to(std::max(receiver.sampler.position(), first->start));
      next_sample_ = std::min(next_sample_, receiver.sampler.next(receiver.mode, clock_.virtual_now()));
    }
  }
}

void Wires::end_sampling() {
  next_sample_ = kNever;
  for (Receiver& receiver : receivers_) {
    receiver.samples = receiver.samples && has_to_sample(receiver);
    if (receiver.samples) {
      next_sample_ = std::min(next_sample_, receiver.sampler.next(receiver.mode, clock_.virtual_now()));
    }
  }
}

void Wires::run_wire() {
  if (next_sample_ != kNever) {
    run_samplers();
  }
  finish_bytes();
  if (next_sample_ != kNever) {
    end_sampling();
  }
  forget_waves();
}

void Wires::run_samplers() {
  for (Receiver& receiver : receivers_) {
    while (receiver.samples) {
      const auto received = receiver.sampler.advance(waves_, receiver.mode, clock_.virtual_now());
      if (!received) {
        break;
      }
      receiver.station->receive(received->byte, received->status);
    }
  }
}

/// Delivers the bytes that have ended, unless they were cut off.
void Wires::finish_bytes() {
  const VirtualTime now = clock_.virtual_now();
  next_byte_end_ = kNever;
  for (std::size_t next = 0; next < waves_.size();) {  // receivers may add bytes
    Wave& wave = waves_[next++];
    if (wave.over) {
      continue;
    }
    if (wave.end > now) {
      next_byte_end_ = std::min(next_byte_end_, wave.end);
      continue;
    }
    wave.over = true;
    --carried_;
    if (wave.cut_off == kNever) {
      deliver(Wave(wave));
    }
  }
}

void Wires::deliver(const Wave& over) {
  const bool has_second_stop_bit = over.nominal.format == LineFormat::k8N2;
  const VirtualTime ends =
      has_second_stop_bit ? over.start + ends_[over.station]->takes(1, over.nominal) : clock_.virtual_now();
  for (WireObserver* observer : observers_) {
    observer->byte(over.station, over.byte, over.nominal, over.collided, over.start, ends);
    for (const std::size_t station : over.also) {
      observer->byte(station, over.byte, over.nominal, over.collided, over.start, ends);
    }
  }
  const VirtualTime quiet_since = std::exchange(quiet_since_, ends);
  if (!over.arrives_whole()) {
    return;
  }
  if (over.start > quiet_since && alone_.size() + groups_.size() > fewest_to_share_) {
    share(over);
  }
  if (!groups_.empty()) {
    for (const auto& group : groups_) {
      if (group->ear.members() != 0 && has_heard_from_the_start(group->receiver, over)) {
        group->ear.hear(over.byte);
      }
    }
    note_silences();
  }
  delivers_ = true;
  for (const std::size_t station : alone_) {
    const Receiver& receiver = receivers_[station];
    if (!receiver.samples && has_heard_from_the_start(receiver, over)) {
      receiver.station->receive(over.byte, ByteStatus::Good);
    }
  }
  delivers_ = false;
  while (!now_alone_.empty()) {
    add_alone(now_alone_.back());
    now_alone_.pop_back();
  }
}

/// From `first` on, the first byte after a gap.
void Wires::share(const Wave& first) {
  for (const std::size_t station : alone_) {
    Receiver& receiver = receivers_[station];
    if (receiver.samples || receiver.sampler.busy() || !has_heard_from_the_start(receiver, first)) {
      continue;
    }
    if (const auto hearing = receiver.station->hearing()) {
      Group& group = group_for(*hearing, receiver);
      if (group.ear.at_rest()) {
        group.receiver.sampler.skip_to(first.start);
        group.ear.add(station, hearing->address);
        receiver.group = &group;
      }
    }
  }
  alone_.erase(std::remove_if(alone_.begin(), alone_.end(),
                              [this](std::size_t station) { return receivers_[station].group != nullptr; }),
               alone_.end());
  for (const auto& group : groups_) {
    if (group->ear.members() < fewest_to_share_) {
      group->ear.dissolve();
    }
  }
}

/// It may have no members yet.
Wires::Group& Wires::group_for(const Hearing& hearing, const Receiver& receiver) {
  for (const auto& group : groups_) {
    if (group->receiver.mode == receiver.mode && group->ear.hears_like(hearing)) {
      return *group;
    }
  }
  groups_.push_back(
      std::make_unique<Group>(clock_, hearing, [this](std::size_t station) { hear_alone(station); }));
  groups_.back()->receiver.mode = receiver.mode;
  return *groups_.back();
}

void Wires::hear_alone(std::size_t station) {
  Receiver& receiver = receivers_[station];
  Group* const group = std::exchange(receiver.group, nullptr);
  if (group == nullptr) {
    return;
  }
  receiver.sampler = group->receiver.sampler;
  if (delivers_) {
    now_alone_.push_back(station);
  } else {
    add_alone(station);
  }
  receiver.station->catch_up(group->ear.remove(station));
  note_silences();
}

void Wires::add_alone(std::size_t station) {
  alone_.insert(std::lower_bound(alone_.begin(), alone_.end(), station), station);
}

void Wires::end_silences() {
  for (const auto& group : groups_) {
    if (group->ear.silence_ends() <= clock_.virtual_now()) {
      group->ear.end_silence();
    }
  }
  note_silences();
}

void Wires::note_silences() {
  next_silence_ = kNever;
  for (const auto& group : groups_) {
    next_silence_ = std::min(next_silence_, group->ear.silence_ends());
  }
}

void Wires::forget_waves() {
  if (next_sample_ == kNever && !carries()) {
    waves_.clear();
    return;
  }
  const auto is_read = [this](const Wave& wave) {
    return std::any_of(receivers_.begin(), receivers_.end(), [&wave](const Receiver& receiver) {
      return receiver.samples && receiver.sampler.position() < wave.end;
    });
  };
  waves_.erase(std::remove_if(waves_.begin(), waves_.end(),
                              [&](const Wave& wave) { return wave.over && !is_read(wave); }),
               waves_.end());
}

}  // namespace ex9000::sim
