// A function with its own stack in the caller's thread. Both sides choose when to switch. A switch takes a
// fraction of the time of a switch between threads.
#pragma once

#include <ucontext.h>

#include <cstddef>
#include <functional>

namespace ex9000::registers {

class Fiber {
 public:
  /// `body` begins with the first `resume`. It must not throw.
  explicit Fiber(std::function<void()> body);
  /// Requires that `body` has returned or has never begun, because its stack is not unwound.
  ~Fiber();
  Fiber(const Fiber&) = delete;
  Fiber& operator=(const Fiber&) = delete;

  /// Runs `body` until it suspends itself or returns. Must not be called from `body` or after `body` has
  /// returned.
  void resume();
  /// Returns to the caller of `resume`. Must be called from `body`.
  void suspend();

 private:
  /// One of the two sides while it does not run.
  struct Side {
    ucontext_t context{};
    const void* stack = nullptr;  ///< its lowest byte
    std::size_t stack_size = 0;
    void* fake_stack = nullptr;  ///< AddressSanitizer's
  };

  static void begin();
  static void go(Side& from, Side& to, bool for_good = false);

  std::function<void()> body_;
  Side outside_;
  Side inside_;
};

}  // namespace ex9000::registers
