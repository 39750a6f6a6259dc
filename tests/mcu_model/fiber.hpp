// A function with a stack of its own in the caller's thread. It is switched to and back where the two sides
// choose, in a fraction of what the operating system takes to switch between threads.
#pragma once

#include <ucontext.h>

#include <cstddef>
#include <functional>

namespace ex9000::registers {

class Fiber {
 public:
  /// `body` begins with the first `resume`. It throws nothing.
  explicit Fiber(std::function<void()> body);
  /// `body` has returned, or has never begun: nothing unwinds its stack.
  ~Fiber();
  Fiber(const Fiber&) = delete;
  Fiber& operator=(const Fiber&) = delete;

  /// Runs `body` until it suspends itself or returns. Not from within it, and not after its return.
  void resume();
  /// From within `body`: back to the caller of `resume`.
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
