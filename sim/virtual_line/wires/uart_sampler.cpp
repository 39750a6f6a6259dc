#include "sim/virtual_line/wires/uart_sampler.hpp"

#include <algorithm>
#include <utility>
#include <vector>

namespace ex9000::sim {

namespace {

constexpr std::int64_t kSecond = 1'000'000'000;

/// 0 while at least one wave is 0.
bool level_of(const Waves& waves, VirtualTime at) {
  return std::all_of(waves.begin(), waves.end(), [at](const Wave& wave) { return wave.level(at); });
}

/// The first time from `from` to before `until` at which the line has `level`; `from` < `until`.
std::optional<VirtualTime> find_level(const Waves& waves, bool level, VirtualTime from, VirtualTime until) {
  std::vector<VirtualTime> boundaries{from};
  for (const Wave& wave : waves) {
    for (unsigned bit = 0; bit <= wave.bits(); ++bit) {
      if (wave.boundary(bit) > from && wave.boundary(bit) < until) {
        boundaries.push_back(wave.boundary(bit));
      }
    }
    if (wave.cut_off > from && wave.cut_off < until) {
      boundaries.push_back(wave.cut_off);
    }
  }
  std::sort(boundaries.begin(), boundaries.end());
  const auto found = std::find_if(boundaries.begin(), boundaries.end(),
                                  [&](VirtualTime at) { return level_of(waves, at) == level; });
  return found == boundaries.end() ? std::nullopt : std::optional(*found);
}

VirtualTime end_of_byte(VirtualTime start, SerialMode mode) {
  return start + VirtualTime(bits_received(mode.format) * kSecond / mode.baud);
}

}  // namespace

VirtualTime Wave::boundary(unsigned index) const { return start + VirtualTime(index * kSecond / mode.baud); }

bool Wave::level(VirtualTime at) const {
  if (at < start || at >= end || at >= cut_off) {
    return true;
  }
  unsigned bit = 0;
  while (at >= boundary(bit + 1)) {
    ++bit;
  }
  return (levels >> bit & 1U) != 0;
}

std::optional<UartSampler::Received> UartSampler::advance(const Waves& waves, SerialMode mode,
                                                          VirtualTime until) {
  while (position_ < until) {
    if (complete_) {
      return end_of_byte(start_, mode) <= until ? std::exchange(complete_, std::nullopt) : std::nullopt;
    }
    if (!receiving_) {
      const auto found = find_level(waves, waits_for_idle_, position_, until);
      position_ = found.value_or(until);
      if (!found) {
        break;
      }
      if (waits_for_idle_) {
        waits_for_idle_ = false;
        continue;
      }
      receiving_ = true;
      start_ = *found;
      bit_ = 0;
      levels_ = 0;
    }
    const VirtualTime middle = start_ + VirtualTime((2 * bit_ + 1) * kSecond / (2 * std::int64_t{mode.baud}));
    if (middle >= until) {
      position_ = until;
      break;
    }
    position_ = middle;
    const bool level = level_of(waves, middle);
    if (bit_ == 0 && level) {
      receiving_ = false;  // a spike, not a start bit
    } else {
      levels_ = static_cast<Levels>(levels_ | (level ? 1U << bit_ : 0U));
      if (bit_ == bits_received(mode.format) - 1) {
        receiving_ = false;
        waits_for_idle_ = !level;
        complete_ = {byte_of(levels_), status_of(levels_, mode.format)};
      }
    }
    ++bit_;
  }
  return std::nullopt;
}

VirtualTime UartSampler::next(SerialMode mode, VirtualTime now) const {
  return complete_ ? end_of_byte(start_, mode) : now + VirtualTime(kSecond / 2 / mode.baud);
}

}  // namespace ex9000::sim
