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
  // NOLINTNEXTLINE(bugprone-sizeof-expression): where T is a pointer, its own size is meant
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

/// Too large for one instruction, and handed over whole: the main loop's until it stores a WrittenByMainLoop
/// that says so, then the interrupts' until they store a WrittenByInterrupt that gives it back. Either side
/// touches it only while it is its own.
template <class T>
class HandedToInterrupt {
 public:
  [[gnu::always_inline]] void set_in_main_loop(const T& value) { value_ = value; }
  [[gnu::always_inline]] T& in_interrupt() { return value_; }

 private:
  T value_{};
};

}  // namespace ex9000
