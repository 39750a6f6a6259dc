// Values that interrupts and the main loop share. The type says which side may write.
#pragma once

#include <atomic>
#include <cstdint>
#include <type_traits>

namespace ex9000 {

namespace detail {

/// An aligned value of at most a machine word: a load or a store is one instruction and needs no lock.
/// Volatile keeps each access. The fences keep the compiler from moving a later access before a load, or an
/// earlier one after a store. The processor needs no fence: both sides run on the same core.
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

/// Only interrupts write, and must not interrupt each other meanwhile. Both sides may read.
template <class T>
class WrittenByInterrupt : public detail::Crossing<T> {
 public:
  [[gnu::always_inline]] void store_in_interrupt(T value) { this->store(value); }
};

/// Only the main loop writes. Both sides may read.
template <class T>
class WrittenByMainLoop : public detail::Crossing<T> {
 public:
  [[gnu::always_inline]] void store_in_main_loop(T value) { this->store(value); }
};

/// Too large for one instruction, so only its owner may access it: first the main loop, which hands it over
/// by storing to a WrittenByMainLoop. The interrupts return it by storing to a WrittenByInterrupt.
template <class T>
class HandedToInterrupt {
 public:
  [[gnu::always_inline]] void set_in_main_loop(const T& value) { value_ = value; }
  [[gnu::always_inline]] T& in_interrupt() { return value_; }

 private:
  T value_{};
};

}  // namespace ex9000
