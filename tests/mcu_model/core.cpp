#include "tests/mcu_model/core.hpp"

#include <algorithm>

namespace ex9000::registers {

namespace {

constexpr std::uint32_t kTickPending = 1U << 26U;
constexpr std::uint32_t kKey = 0x05FA;

}  // namespace

Core::Core(const SystemControl& clock, Timeline& timeline)
    : Peripheral(kBase), clock_(clock), timeline_(timeline), tick_(timeline, [this] { count_tick(); }) {}

/// Returns the SysTick counter. In this model, the counter is 0 while it is disabled. While it is enabled,
/// each clock cycle decrements it, except that a clock cycle at 0 loads the reload value. If the SysTick
/// exception is enabled, it becomes pending when the counter reaches 0.
std::uint32_t Core::current() const {
  if ((tick_control_ & 1U) == 0) {
    return 0;
  }
  const std::int64_t clocks = (timeline_.now() - tick_began_) / clock_.cycle();
  return clocks == 0 ? 0 : static_cast<std::uint32_t>(reload_ + 1 - clocks);
}

void Core::count_tick() {
  tick_began_ = timeline_.now();
  tick_.set_after((reload_ + std::int64_t{1}) * clock_.cycle());
  if ((tick_control_ & 2U) != 0) {
    pend(kTick);
  }
}

std::uint32_t Core::read(std::uint32_t offset) {
  switch (offset) {
    case kTickCurrent:
      return current();
    case kInterruptControl:
      return (pending_ >> kTick & 1U) != 0 ? kTickPending : 0;
    default:
      fault(offset, "the model has no such register of the processor");
  }
}

void Core::write(std::uint32_t offset, std::uint32_t value) {
  if (offset >= kPriority && offset < kPriority + 32) {
    for (unsigned i = 0; i < 4; ++i) {
      // Only the upper three bits of each byte exist.
      priorities_.at(offset - kPriority + i) = static_cast<std::uint8_t>(value >> (8 * i) & 0xE0U);
    }
    return;
  }
  switch (offset) {
    case kTickControl:
      if ((value & 4U) == 0) {
        fault(offset, "SysTick must use the system clock");
      }
      if ((value & 1U) != 0 && (tick_control_ & 1U) == 0) {
        tick_began_ = timeline_.now();
        tick_.set_after((reload_ + std::int64_t{1}) * clock_.cycle());
      } else if ((value & 1U) == 0) {
        tick_.cancel();
      }
      tick_control_ = value;
      break;
    case kTickReload:
      if (value > 0xFF'FFFFU) {
        fault(offset, "the reload value has more than 24 bits");
      }
      reload_ = value;
      break;
    case kTickCurrent:
      if ((tick_control_ & 1U) != 0) {
        fault(offset, "the counter must not be written while it runs");
      }
      break;
    case kSetEnable:
      enabled_ |= value;
      break;
    case kApplicationInterrupt:
      if (value >> 16U != kKey) {
        fault(offset, "the write requires the key 0x05FA");
      }
      group_shift_ = value >> 8U & 7U;
      if ((value & 4U) != 0 && on_reset_) {
        on_reset_();
      }
      break;
    default:
      fault(offset, "the model has no writable register of the processor here");
  }
}

unsigned Core::priority_of(unsigned exception) const {
  return exception < kFirstInterrupt ? 0 : priorities_.at(exception - kFirstInterrupt);
}

void Core::pend(unsigned exception) {
  const std::uint64_t bit = 1ULL << exception;
  if ((pending_ & bit) == 0) {
    pending_ |= bit;
    since_.at(exception) = timeline_.now();
  }
}

/// Sets the level of an interrupt line. A line that `stick` has asserted stays asserted. A pending exception
/// stays pending when its line goes low.
void Core::interrupt_line_of(unsigned interrupt, bool asserted) {
  lines_.at(interrupt) = (asserted && (lost_ >> interrupt & 1U) == 0) || (stuck_ >> interrupt & 1U) != 0;
  if (lines_.at(interrupt)) {
    pend(kFirstInterrupt + interrupt);
  }
}

/// Returns the exception to serve next; 0 if there is none. Ignores whether `hold` delays all exceptions.
unsigned Core::next_to_serve() const {
  const std::uint64_t candidates = waiting();
  unsigned best = 0;
  for (unsigned exception = kTick; candidates >> exception != 0; ++exception) {
    if ((candidates >> exception & 1U) != 0 && since_.at(exception) + latency_ <= timeline_.now() &&
        (best == 0 || priority_of(exception) < priority_of(best))) {
      best = exception;
    }
  }
  if (best != 0 && !active_.empty() && group(priority_of(best)) >= group(priority_of(active_.back()))) {
    return 0;
  }
  return best;
}

Instant Core::next_wake() const {
  const std::uint64_t candidates = waiting();
  Instant next = kNever;
  for (unsigned exception = kTick; candidates >> exception != 0; ++exception) {
    if ((candidates >> exception & 1U) != 0) {
      next = std::min(next, since_.at(exception) + latency_);
    }
  }
  return next;
}

void Core::serve_pending() {
  while (!held_) {
    const unsigned exception = next_to_serve();
    if (exception == 0) {
      return;
    }
    pending_ &= ~(1ULL << exception);
    active_.push_back(exception);
    deepest_ = std::max(deepest_, active_.size());
    serve_(exception);
    active_.pop_back();
    if (exception >= kFirstInterrupt && lines_.at(exception - kFirstInterrupt)) {
      pend(exception);
    }
  }
}

}  // namespace ex9000::registers
