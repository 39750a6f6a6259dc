// Replaces firmware/crossing.hpp and has the same interface. An interrupt can occur before and after
// each access by the main loop. The classes throw std::logic_error if an interrupt calls a function for the
// main loop, if the main loop calls a function for interrupts, or if an interrupt uses a value while the main
// loop writes it.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <type_traits>

#include "tests/support/interleaving/points.hpp"

namespace ex9000 {

namespace detail {

inline void require_side(bool interrupt) {
  if (interleaving::Points::in_interrupt() != interrupt) {
    throw std::logic_error(
        "an interrupt has called a function for the main loop, or the main loop has called a function "
        "for interrupts");
  }
}

template <class T>
class Crossing {
  static_assert(std::is_trivially_copyable<T>::value && sizeof(T) <= sizeof(void*),
                "T must be trivially copyable and at most as large as a machine word");

 public:
  [[nodiscard]] T load() const {
    interleaving::Points::pass();
    const T value = value_;
    interleaving::Points::pass();
    return value;
  }

 protected:
  void store(T value) {
    interleaving::Points::pass();
    value_ = value;
    interleaving::Points::pass();
  }

 private:
  T value_{};
};

}  // namespace detail

template <class T>
class WrittenByInterrupt : public detail::Crossing<T> {
 public:
  void store_in_interrupt(T value) {
    detail::require_side(true);
    this->store(value);
  }
};

template <class T>
class WrittenByMainLoop : public detail::Crossing<T> {
 public:
  void store_in_main_loop(T value) {
    detail::require_side(false);
    this->store(value);
  }
};

template <class T>
class HandedToInterrupt {
 public:
  void set_in_main_loop(const T& value) {
    detail::require_side(false);
    torn_ = true;
    interleaving::Points::pass();
    value_ = value;
    interleaving::Points::pass();
    torn_ = false;
  }
  T& in_interrupt() {
    detail::require_side(true);
    if (torn_) {
      throw std::logic_error("an interrupt uses a value while the main loop writes it");
    }
    return value_;
  }

 private:
  bool torn_ = false;
  T value_{};
};

}  // namespace ex9000
