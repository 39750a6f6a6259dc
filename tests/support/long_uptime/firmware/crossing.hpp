// Replaces firmware/crossing.hpp and has the same interface. Each std::uint32_t in a Crossing starts 100
// counts before it wraps to 0. A counter can have such a value after months of operation. The core works with
// these start values, because it uses only changes of a counter, differences between two counters, and the
// lowest bits of the counters in FrameQueue. The core writes other shared values, for example the module's
// address, before it uses them. Exception: the diagnostic counters (firmware/line/line_tallies.hpp) do not
// start at 0, so a test that reads them must clear them first.
#pragma once

#include <cstdint>
#include <type_traits>

namespace ex9000 {

constexpr std::uint32_t kCountsUntilTheWrap = 100;

namespace detail {

template <class T>
class Crossing {
  static_assert(std::is_trivially_copyable<T>::value && sizeof(T) <= sizeof(std::uintptr_t),
                "T must be trivially copyable and at most as large as a machine word");

 public:
  [[nodiscard]] T load() const { return value_; }

 protected:
  void store(T value) { value_ = value; }

 private:
  static constexpr T beginning() {
    if constexpr (std::is_same<T, std::uint32_t>::value) {
      return 0U - kCountsUntilTheWrap;
    } else {
      return T();
    }
  }

  T value_ = beginning();
};

}  // namespace detail

template <class T>
class WrittenByInterrupt : public detail::Crossing<T> {
 public:
  void store_in_interrupt(T value) { this->store(value); }
};

template <class T>
class WrittenByMainLoop : public detail::Crossing<T> {
 public:
  void store_in_main_loop(T value) { this->store(value); }
};

template <class T>
class HandedToInterrupt {
 public:
  void set_in_main_loop(const T& value) { value_ = value; }
  T& in_interrupt() { return value_; }

 private:
  T value_{};
};

}  // namespace ex9000
