#include "tests/world/generator.hpp"

#include <algorithm>
#include <iterator>
#include <utility>

#include "tests/world/limits.hpp"

namespace ex9000::world {

namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

enum What : unsigned {
  kPower,
  kReset,
  kHang,
  kDelay,
  kTick,
  kInit,
  kMemory,
  kSpoiled,
  kNoise,
  kSlots,
  kBadImages,
  kInputs,
  // not a step of its own
  kDamaged,
  kOtherMode,
  kEarly,
  kOthers,
  kWatchdog,
  kUpdate,
  kLongImages,
  kCount,
};

/// What happens besides requests, once in so many steps.
struct Fault {
  What what;
  unsigned times;
};
constexpr Fault kFaults[] = {{kPower, 60}, {kReset, 60},  {kHang, 200},     {kDelay, 60},
                             {kTick, 400}, {kInit, 40},   {kMemory, 100},   {kSpoiled, 40},
                             {kNoise, 60}, {kSlots, 150}, {kBadImages, 60}, {kInputs, 4}};

}  // namespace

Generator::Generator(std::uint64_t seed, const Requests& requests)
    : requests_(requests),
      random_(seed),
      left_out_(random_.below(1U << kCount)),
      loud_(random_.below(1U << kCount) & random_.below(1U << kCount)) {
  const unsigned count = random_.once_in(3) ? 1 + random_.below(12) : 1 + random_.below(3);
  for (unsigned i = 0; i < count; ++i) {
    setup_.members.push_back(member());
  }
  places_.resize(count);
  images_.resize(count);
  setup_.masters = 1 + random_.below(3);
  // The clock of the firmware wraps after 2^32 us.
  constexpr microseconds kWrap{4'294'967'296};
  setup_.begins = random_.once_in(3) ? kWrap - milliseconds(random_.below(3000)) : Time(0);
}

/// Returns whether something happens now that happens once in `times` steps on average, unless this run
/// leaves it out or has more of it.
bool Generator::often(unsigned what, unsigned times) {
  const bool loud = (loud_ >> what & 1U) != 0;
  return random_.once_in(loud ? std::max(2U, times / 5) : times) && (left_out_ >> what & 1U) == 0;
}

Member Generator::member() {
  const auto any_row = [this] {
    return &reference::kModelRows[random_.below(static_cast<unsigned>(std::size(reference::kModelRows)))];
  };
  const reference::ModelRow* row = any_row();
  if (!row->both_protocols && random_.once_in(2)) {
    row = any_row();
  }
  Member member{row, random_.once_in(4), {}, random_.once_in(4) ? 0 : 0x0D000000 + random_.below(0x10000)};
  const reference::Module module(*member.row);
  member.stored = module.stored();
  if (member.blank) {
    return member;
  }
  reference::Stored& stored = member.stored;
  stored.address = random_.once_in(6) ? random_.between(1, 247) : random_.between(1, 12);
  stored.baud_code = random_.once_in(2) ? 0x06 : random_.between(0x03, 0x0A);
  if (random_.once_in(2)) {
    stored.baud_code |= random_.below(4) << 6U;
  }
  stored.format = random_.one_of({0x00U, 0x40U, 0x80U, 0xC0U});
  stored.modbus = member.row->both_protocols && !random_.once_in(3);
  const unsigned all = (1U << member.row->outputs) - 1;
  stored.power_on = random_.below(0x10000) & all;
  stored.safe = random_.below(0x10000) & all;
  stored.enabled = random_.once_in(2);
  stored.timeout = random_.once_in(2) ? 1 + random_.below(10) : 1 + random_.below(255);
  stored.timed_out = random_.once_in(8);
  stored.restarted_by_requests = random_.once_in(4) ? 1 : 0;
  stored.updates_allowed = random_.once_in(8) ? 0 : 1;
  stored.delay = random_.once_in(4) ? random_.below(31) : 0;
  const bool filters = random_.once_in(2);
  for (unsigned channel = 0; channel < member.row->inputs; ++channel) {
    stored.filters[channel] = filters && random_.once_in(2) ? random_.below(200) : 0;
  }
  stored.serial_number = random_.once_in(4) ? 0x0D000000 + random_.below(0x10000) : 0;
  stored.inversion = random_.once_in(4) ? random_.below(0x10000) & ((1U << member.row->inputs) - 1) : 0;
  return member;
}

Bytes Generator::request(std::size_t index, const Possible& target) {
  const reference::Module& module = target.module();
  if (module.settling_input() && random_.once_in(4)) {
    return Requests::set_filter(module, *module.settling_input(), random_);
  }
  if (!module.expiry() && often(kWatchdog, 10)) {
    return Requests::of_watchdog(module, random_);
  }
  Bytes bytes = requests_.next(module, random_, places_[index]);
  if (often(kDamaged, 12) && !bytes.empty()) {
    switch (random_.below(4)) {
      case 0:
        bytes.resize(1 + random_.below(static_cast<unsigned>(bytes.size())));
        break;
      case 1:
        bytes[random_.below(static_cast<unsigned>(bytes.size()))] ^=
            static_cast<std::uint8_t>(1U << random_.below(8));
        break;
      case 2:
        bytes.insert(bytes.begin(), 0x00);
        break;
      default:
        bytes.insert(bytes.end(), 1 + random_.below(random_.once_in(8) ? 300 : 8),
                     static_cast<std::uint8_t>(random_.below(256)));
        break;
    }
  }
  return bytes;
}

/// The time that a request takes, with the silence after it.
Time Generator::time_of(const Send& send) {
  const auto bits = static_cast<std::int64_t>(11 * send.bytes.size() + 30);
  return Time(bits * 1'000'000'000 / send.mode.baud);
}

Send Generator::send(std::size_t index, const Possible& target) {
  const reference::Module& module = target.module();
  hal::SerialMode mode{module.powered() ? module.rate() : 9600,
                       module.powered() ? module.format() : LineFormat::k8N1};
  if (often(kOtherMode, 30)) {
    mode.baud = random_.one_of({1200U, 4800U, 9600U, 19200U, 115200U});
    mode.format = random_.one_of({LineFormat::k8N1, LineFormat::k8N2, LineFormat::k8E1, LineFormat::k8O1});
  }
  const std::size_t master =
      often(kOthers, 3) ? random_.below(static_cast<unsigned>(setup_.masters)) : std::size_t{0};
  return {master, mode, request(index, target)};
}

Step Generator::fault(unsigned what, std::size_t index, const Plant& plant) {
  const reference::Module& module = plant.likely(index).module();
  switch (what) {
    case kPower:
      return Power{index, !plant.powered(index)};
    case kReset:
      return Reset{index};
    case kHang:
      return Hang{index, Time(0)};
    case kDelay:
      return Hang{index, microseconds(random_.below(random_.once_in(4) ? 1'000'000 : 30'000))};
    case kTick:
      return TickStops{index};
    case kInit:
      return Init{index, !module.init_asserted()};
    case kMemory:
      return MemoryFails{index, random_.once_in(3)};
    case kSpoiled:
      return SpoilReply{index, random_.once_in(2) ? Time(0) : Time(milliseconds(random_.below(100)))};
    case kSlots:
      return SlotsFail{index, random_.once_in(3)};
    case kBadImages:
      return BadImages{index, random_.once_in(3)};
    case kNoise: {
      sim::NoiseRates rates;
      if (random_.once_in(2)) {
        rates.flipped_bit = random_.once_in(2) ? 0.001 : 0.01;
        rates.lost_character = random_.once_in(2) ? 0.01 : 0;
        rates.stray_character = random_.once_in(2) ? 0.01 : 0;
        rates.stray_zero = random_.once_in(2) ? 0.02 : 0;
      }
      return Noise{rates};
    }
    default: {
      unsigned channel = random_.below(std::max(1U, module.row().inputs));
      if (module.settling_input() && random_.once_in(2)) {
        channel = *module.settling_input();
      }
      return random_.once_in(2) ? Step(Input{index, channel, random_.once_in(2)})
                                : Step(Pulse{index, channel, 1 + random_.below(5)});
    }
  }
}

/// Plans a fault and what belongs to it: INIT* may bounce, and something may happen during a start, which
/// takes 10 to 30 ms.
void Generator::add(unsigned what, std::size_t index, const Plant& plant) {
  plan_.push_back(fault(what, index, plant));
  if (what == kInit && random_.once_in(3)) {
    plan_.emplace_back(Wait{microseconds(random_.below(12'000))});
    plan_.emplace_back(Init{index, plant.likely(index).module().init_asserted()});
  }
  if ((what == kReset || what == kPower) && random_.once_in(4)) {
    plan_.emplace_back(Wait{microseconds(random_.below(30'000))});
    disturb(index, plant);
  }
}

/// Any fault that this run does not leave out. A memory that fails works again later, and then a reset shows
/// what it holds.
void Generator::disturb(std::size_t index, const Plant& plant) {
  const Fault& one = kFaults[random_.below(static_cast<unsigned>(std::size(kFaults)))];
  if ((left_out_ >> one.what & 1U) != 0) {
    return;
  }
  if (one.what == kSlots) {
    plan_.emplace_back(SlotsFail{index, true});
    plan_.emplace_back(Wait{milliseconds(random_.below(500))});
    plan_.emplace_back(SlotsFail{index, false});
    return;
  }
  if (one.what != kMemory) {
    add(one.what, index, plant);
    return;
  }
  plan_.emplace_back(MemoryFails{index, true});
  plan_.emplace_back(Wait{milliseconds(random_.below(500))});
  plan_.emplace_back(MemoryFails{index, false});
  plan_.emplace_back(Wait{milliseconds(random_.below(3000))});
  plan_.emplace_back(Reset{index});
}

/// At the expiry of the host watchdog, a request arrives or a fault happens.
void Generator::aim_at(Time expiry, std::size_t index, const Plant& plant) {
  const Possible& target = plant.likely(index);
  const Time left = expiry - plant.now();
  const Time before = microseconds(random_.below(random_.once_in(2) ? 20'000 : 150'000));
  if (random_.once_in(4)) {
    plan_.emplace_back(Wait{std::max(Time(0), left - milliseconds(10) + before)});
    disturb(index, plant);
    return;
  }
  Send request = send(index, target);
  for (unsigned tries = random_.below(30); tries != 0 && !target.would_store(request.bytes); --tries) {
    request.bytes = random_.once_in(2) ? Requests::of_watchdog(target.module(), random_)
                                       : requests_.next(target.module(), random_, places_[index]);
  }
  plan_.emplace_back(Wait{std::max(Time(0), left - time_of(request) - before + milliseconds(10))});
  if ((left_out_ >> kDelay & 1U) == 0 && random_.once_in(4)) {
    plan_.emplace_back(Hang{index, time_of(request) + microseconds(random_.below(60'000))});
  }
  plan_.emplace_back(request);
  plan_.emplace_back(Wait{time_of(request) + microseconds(random_.below(60'000))});
}

/// A step of an update, or many. A fault often happens meanwhile, or near the end of the time after which a
/// new image is confirmed.
void Generator::update(std::size_t index, const Plant& plant) {
  const reference::Module& module = plant.likely(index).module();
  const reference::Update& now = module.update();
  Requests::Image& image = images_[index];
  Send request{0, {module.rate(), module.format()}, {}};
  const auto ask = [&](Bytes bytes) {
    request.bytes = random_.once_in(16)   ? Requests::by_number(module, std::move(bytes))
                    : random_.once_in(16) ? Requests::broadcast(std::move(bytes))
                                          : std::move(bytes);
    plan_.emplace_back(request);
    if (random_.once_in(12)) {
      plan_.emplace_back(
          Wait{time_of(request) + microseconds(random_.below(random_.once_in(2) ? 5000 : 90'000))});
      disturb(index, plant);
    }
    plan_.emplace_back(Wait{time_of(request) + milliseconds(4 + random_.below(20))});
  };
  const auto wait_for_proof = [&](Time from) {
    const Time moment = random_.once_in(2) ? kProvesItself + microseconds(random_.below(3'500'000))
                                           : Time(milliseconds(random_.below(62'000)));
    plan_.emplace_back(Wait{std::max(Time(0), from + moment - milliseconds(1500) - plant.now())});
    if (random_.once_in(3)) {
      disturb(index, plant);
    } else {
      ask(Requests::state_of_update(module));
    }
  };
  if (now.state == reference::UpdateState::Unconfirmed && random_.once_in(3)) {
    wait_for_proof(module.came_up().latest + now.periods * kProvesItself);
    return;
  }
  if (now.state == reference::UpdateState::Receiving && now.spare.begin == image.begin &&
      random_.once_in(2)) {
    for (std::size_t offset = now.spare.size(); offset < image.content.size(); offset += 128) {
      ask(Requests::block(module, image, offset));
    }
    return;
  }
  ask(Requests::of_update(module, random_, image, often(kLongImages, 10)));
  if ((left_out_ >> kReset & 1U) == 0 &&
      random_.once_in(now.state == reference::UpdateState::Unconfirmed ? 6 : 12)) {
    if (random_.once_in(2)) {
      plan_.emplace_back(Reset{index});
    } else {
      plan_.emplace_back(Power{index, false});
      plan_.emplace_back(Wait{milliseconds(random_.below(100))});
      plan_.emplace_back(Power{index, true});
    }
    plan_.emplace_back(Wait{milliseconds(60)});
    ask(Requests::state_of_update(module));
    return;
  }
  if (now.state != reference::UpdateState::Complete) {
    return;
  }
  if (random_.once_in(3)) {
    wait_for_proof(plant.now());
  } else if (random_.once_in(2)) {
    // A request arrives while the reply leaves, or before the reset.
    plan_.back() = Wait{time_of(request) + microseconds(random_.below(50'000))};
    plan_.emplace_back(send(index, plant.likely(index)));
    plan_.emplace_back(Wait{milliseconds(random_.below(300))});
  }
}

/// Sends a request. If it stores settings, a fault often happens while it is stored.
void Generator::ask(std::size_t index, const Plant& plant) {
  const Possible& target = plant.likely(index);
  const Send request = send(index, target);
  plan_.emplace_back(request);
  if (target.would_store(request.bytes) && random_.once_in(3)) {
    plan_.emplace_back(Wait{time_of(request) + microseconds(random_.below(90'000))});
    disturb(index, plant);
  }
  for (unsigned waits = 1 + random_.below(2); waits != 0; --waits) {
    plan_.emplace_back(Wait{often(kEarly, 8)      ? Time(microseconds(random_.below(6000)))
                            : random_.once_in(30) ? Time(milliseconds(random_.below(3000)))
                                                  : Time(milliseconds(20 + random_.below(40)))});
  }
}

void Generator::decide(const Plant& plant) {
  const std::size_t index =
      aim_ ? *std::exchange(aim_, {}) : random_.below(static_cast<unsigned>(plant.size()));
  const reference::Module& module = plant.likely(index).module();
  if (!plant.powered(index) && random_.once_in(3)) {
    add(kPower, index, plant);
    return;
  }
  if (random_.once_in(8000)) {  // the clock of the firmware wraps after 71 minutes
    plan_.emplace_back(Wait{std::chrono::minutes(1 + random_.below(120))});
    return;
  }
  for (const Fault& each : kFaults) {
    // What waits for something gets it more often.
    const bool sooner = (each.what == kReset && module.powered() && module.waits_for_reset()) ||
                        (each.what == kInit && module.init_asserted());
    if ((each.what != kInputs || module.row().inputs != 0) && often(each.what, sooner ? 10 : each.times)) {
      if (each.what == kInputs) {
        aim_ = index;  // a request often arrives while the time of a filter runs
        if (random_.once_in(40)) {
          // So many pulses that counters wrap, but not faster than an input can count them.
          const unsigned channel = random_.below(module.row().inputs);
          for (unsigned pulses = 1 + random_.below(6); pulses != 0; --pulses) {
            plan_.emplace_back(Pulse{index, channel, 20'000});
            plan_.emplace_back(Wait{milliseconds(1000)});
          }
        }
      }
      add(each.what, index, plant);
      return;
    }
  }
  if (plant.likely(index).hangs(plant.now()) && !random_.once_in(4)) {
    // The more frames wait, the more of them may be lost.
    plan_.emplace_back(Wait{milliseconds(random_.below(100))});
  } else if (module.expiry() && random_.once_in(3) && plant.now() < module.expiry()->earliest &&
             module.expiry()->earliest < plant.now() + milliseconds(3000)) {
    aim_at(module.expiry()->earliest, index, plant);
  } else if (plant.powered(index) && module.runs_modbus() && often(kUpdate, 12)) {
    update(index, plant);
  } else {
    ask(index, plant);
  }
}

Step Generator::next(const Plant& plant) {
  if (plan_.empty()) {
    decide(plant);
  }
  Step step = plan_.front();
  plan_.pop_front();
  return step;
}

}  // namespace ex9000::world
