#include "tests/world/generator.hpp"

#include <iterator>
#include <utility>

namespace ex9000::world {

namespace {

using std::chrono::microseconds;
using std::chrono::milliseconds;

enum What : unsigned {
  kPower,
  kReset,
  kInputs,
  kHang,
  kMemory,
  kSpoiled,
  kNoise,
  kDamaged,
  kOtherMode,
  kEarly,
  kOthers,
  kInit,
  kDelays,
  kTick,
  kCount,
};

}  // namespace

Generator::Generator(std::uint64_t seed, const Requests& requests)
    : requests_(requests), random_(seed), left_out_(random_.below(1U << kCount)) {
  const unsigned count = random_.once_in(3) ? 1 + random_.below(12) : 1 + random_.below(3);
  for (unsigned i = 0; i < count; ++i) {
    setup_.members.push_back(member());
  }
  places_.resize(count);
  setup_.masters = 1 + random_.below(3);
  // The clock of the firmware wraps after 2^32 us.
  constexpr microseconds kWrap{4'294'967'296};
  setup_.begins = random_.once_in(3) ? kWrap - milliseconds(random_.below(3000)) : Time(0);
}

/// Returns whether something happens now that happens once in `times` steps on average, unless this run
/// leaves it out.
bool Generator::often(unsigned what, unsigned times) {
  return random_.once_in(times) && (left_out_ >> what & 1U) == 0;
}

Member Generator::member() {
  const auto any_row = [this] {
    return &reference::kModelRows[random_.below(static_cast<unsigned>(std::size(reference::kModelRows)))];
  };
  const reference::ModelRow* row = any_row();
  if (!row->both_protocols && random_.once_in(2)) {
    row = any_row();
  }
  Member member{row, random_.once_in(4), {}};
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
  stored.delay = random_.once_in(4) ? random_.below(31) : 0;
  const bool filters = random_.once_in(2);
  for (unsigned channel = 0; channel < member.row->inputs; ++channel) {
    stored.filters[channel] = filters && random_.once_in(2) ? random_.below(200) : 0;
  }
  stored.inversion = random_.once_in(4) ? random_.below(0x10000) & ((1U << member.row->inputs) - 1) : 0;
  return member;
}

Bytes Generator::request(std::size_t index, const Possible& target) {
  const reference::Module& module = target.module();
  if (module.settling_input() && random_.once_in(4)) {
    return requests_.set_filter(module, *module.settling_input(), random_);
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

Step Generator::next(const Plant& plant) {
  const std::size_t index =
      aim_ ? *std::exchange(aim_, {}) : random_.below(static_cast<unsigned>(plant.size()));
  const Time now = plant.now();
  if (pulses_ != 0) {  // so many pulses that counters wrap, but not faster than an input can count them
    --pulses_;
    return pulses_ % 2 == 0 ? Step(Wait{milliseconds(1000)}) : Step(pulsing_);
  }
  if (!plant.powered(index) && random_.once_in(3)) {
    return Power{index, true};
  }
  const Possible& target = plant.likely(index);
  if (waits_ != 0) {
    --waits_;
    if (often(kEarly, 8)) {
      return Wait{microseconds(random_.below(6000))};
    }
    return Wait{random_.once_in(30) ? Time(milliseconds(random_.below(3000)))
                                    : Time(milliseconds(20 + random_.below(40)))};
  }
  if (often(kPower, 60)) {
    return Power{index, !plant.powered(index)};
  }
  // A module whose settings or INIT* wait for a reset gets one more often.
  if (often(kReset, target.module().powered() && target.module().waits_for_reset() ? 10 : 60)) {
    return Reset{index};
  }
  if (often(kHang, 200)) {
    return Hang{index, Time(0)};
  }
  if (often(kDelays, 60)) {
    return Hang{index, microseconds(random_.below(random_.once_in(4) ? 1'000'000 : 30'000))};
  }
  if (often(kTick, 400)) {
    return TickStops{index};
  }
  if (often(kInit, target.module().init_asserted() ? 20 : 40)) {
    return Init{index, !target.module().init_asserted()};
  }
  if (often(kMemory, 100)) {
    return MemoryFails{index, random_.once_in(3)};
  }
  if (often(kSpoiled, 40)) {
    return SpoilReply{index, random_.once_in(2) ? Time(0) : Time(milliseconds(random_.below(100)))};
  }
  if (often(kNoise, 60)) {
    sim::NoiseRates rates;
    if (random_.once_in(2)) {
      rates.flipped_bit = random_.once_in(2) ? 0.001 : 0.01;
      rates.lost_character = random_.once_in(2) ? 0.01 : 0;
      rates.stray_character = random_.once_in(2) ? 0.01 : 0;
      rates.stray_zero = random_.once_in(2) ? 0.02 : 0;
    }
    return Noise{rates};
  }
  if (target.module().row().inputs != 0 && often(kInputs, 4)) {
    unsigned channel = random_.below(target.module().row().inputs);
    if (target.module().settling_input() && random_.once_in(2)) {
      channel = *target.module().settling_input();
    }
    if (random_.once_in(40)) {
      pulses_ = 2 * (1 + random_.below(6));
      pulsing_ = Pulse{index, channel, 20'000};
    }
    aim_ = index;  // a request often arrives while the time of a filter runs
    return random_.once_in(2) ? Step(Input{index, channel, random_.once_in(2)})
                              : Step(Pulse{index, channel, 1 + random_.below(5)});
  }
  const reference::Module& module = target.module();
  // A request often arrives when the host watchdog expires.
  if (module.expiry() && random_.once_in(4)) {
    const Time before = microseconds(random_.below(random_.once_in(2) ? 20'000 : 200'000));
    if (const Time then = module.expiry()->earliest - before; then > now && then < now + milliseconds(3000)) {
      aim_ = index;
      return Wait{then - now};
    }
  }
  hal::SerialMode mode{module.powered() ? module.rate() : 9600,
                       module.powered() ? module.format() : LineFormat::k8N1};
  if (often(kOtherMode, 30)) {
    mode.baud = random_.one_of({1200U, 4800U, 9600U, 19200U, 115200U});
    mode.format = random_.one_of({LineFormat::k8N1, LineFormat::k8N2, LineFormat::k8E1, LineFormat::k8O1});
  }
  waits_ = 1 + random_.below(2);
  const std::size_t master =
      often(kOthers, 3) ? random_.below(static_cast<unsigned>(setup_.masters)) : std::size_t{0};
  return Send{master, mode, request(index, target)};
}

}  // namespace ex9000::world
