// What crosses between interrupt and main loop: a value with one writer, whose type says which side that is.
#pragma once

#include <atomic>
#include <cstdint>
#include <type_traits>

namespace ex9000 {

namespace detail {

/// One aligned value up to a machine word, so that a load or a store is one instruction and needs no lock;
/// volatile, so that it is one each time. There is one core: what the compiler must not do is move other
/// accesses across it, and that is what the fence forbids.
template <class T>
class Crossing {
  static_assert(std::is_trivially_copyable<T>::value && sizeof(T) <= sizeof(std::uintptr_t),
                "must be read and written by one instruction");

 public:
  [[nodiscard, gnu::always_inline]] T load() const {
    const T value = value_;
    std::atomic_signal_fence(std::memory_order_acquire);
    return value;
  }

 protected:
  [[gnu::always_inline]] void store(T value) {
    std::atomic_signal_fence(std::memory_order_release);
    value_ = value;
  }

 private:
  volatile T value_{};
};

}  // namespace detail

/// Written by interrupts only, which must not interrupt each other while they write it; read by anybody.
template <class T>
class WrittenByInterrupt : public detail::Crossing<T> {
 public:
  [[gnu::always_inline]] void store_in_interrupt(T value) { this->store(value); }
};

/// Written by the main loop only; read by anybody.
template <class T>
class WrittenByMainLoop : public detail::Crossing<T> {
 public:
  [[gnu::always_inline]] void store_in_main_loop(T value) { this->store(value); }
};

/// Counts events in an interrupt and hands them to the main loop, none lost and none twice, as long as the
/// main loop collects before 65536 have gathered. Neither side ever writes what the other writes.
class EventTally {
 public:
  /// Interrupt.
  [[gnu::always_inline]] void count_in_interrupt(unsigned events = 1) {
    total_.store_in_interrupt(static_cast<std::uint16_t>(total_.load() + events));
  }

  /// Main loop: how many since `collect` or `clear` was last called, modulo 65536.
  [[nodiscard]] std::uint16_t count() const { return static_cast<std::uint16_t>(total_.load() - collected_); }
  /// Main loop: likewise, and begins anew.
  std::uint16_t collect() {
    const std::uint16_t total = total_.load();
    const auto fresh = static_cast<std::uint16_t>(total - collected_);
    collected_ = total;
    return fresh;
  }
  void clear() { collected_ = total_.load(); }

 private:
  WrittenByInterrupt<std::uint16_t> total_;
  std::uint16_t collected_ = 0;  // main loop
};

}  // namespace ex9000
