// Values that interrupts and the main loop share. The type of a value defines which side may write it.
#pragma once

#include <atomic>
#include <cstdint>
#include <type_traits>

namespace ex9000 {

namespace detail {

/// An aligned value of at most a machine word, so that a load or a store is one instruction and needs no
/// lock. It is volatile, so that the compiler keeps each access. The fences prevent the compiler from moving
/// a later access before a load, or an earlier access after a store. Fences for the processor are not
/// necessary, because the interrupts and the main loop run on the same core.
template <class T>
class Crossing {
  // NOLINTNEXTLINE(bugprone-sizeof-expression): if T is a pointer, the size of the pointer is meant
  static_assert(std::is_trivially_copyable<T>::value && sizeof(T) <= sizeof(std::uintptr_t),
                "T must be trivially copyable and at most as large as a machine word");

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

/// Only interrupts write this value, and they must not interrupt each other while they write it. Interrupts
/// and the main loop may read it.
template <class T>
class WrittenByInterrupt : public detail::Crossing<T> {
 public:
  [[gnu::always_inline]] void store_in_interrupt(T value) { this->store(value); }
};

/// Only the main loop writes this value. Interrupts and the main loop may read it.
template <class T>
class WrittenByMainLoop : public detail::Crossing<T> {
 public:
  [[gnu::always_inline]] void store_in_main_loop(T value) { this->store(value); }
};

/// A value that is too large for one instruction, so only one side at a time owns it. The main loop owns it
/// first and hands it over by storing to a WrittenByMainLoop. The interrupts return it by storing to a
/// WrittenByInterrupt. A side may access the value only while it owns the value.
template <class T>
class HandedToInterrupt {
 public:
  [[gnu::always_inline]] void set_in_main_loop(const T& value) { value_ = value; }
  [[gnu::always_inline]] T& in_interrupt() { return value_; }

 private:
  T value_{};
};

}  // namespace ex9000
