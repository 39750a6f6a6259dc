// A function that runs on its own stack in the thread of its caller. The function runs only while the caller
// waits in `resume`. A switch between the caller and the function takes much less time than a switch between
// threads.
#pragma once

#include <ucontext.h>

#include <cstddef>
#include <functional>

namespace ex9000::registers {

class Fiber {
 public:
  /// Allocates the stack; throws std::system_error if this fails. The first `resume` starts `body`, which
  /// must not throw.
  explicit Fiber(std::function<void()> body);
  /// Requires that `body` has returned or has never begun, because its stack is not unwound.
  ~Fiber();
  Fiber(const Fiber&) = delete;
  Fiber& operator=(const Fiber&) = delete;

  /// Runs `body` until it calls `suspend` or returns. Must not be called from `body` or after `body` has
  /// returned.
  void resume();
  /// Returns to the caller of `resume`. Must be called from `body`.
  void suspend();

 private:
  /// The state of one side, the caller or `body`, while that side does not run.
  struct Side {
    ucontext_t context{};
    const void* stack = nullptr;  ///< the lowest address of its stack
    std::size_t stack_size = 0;
    void* fake_stack = nullptr;  ///< a value that AddressSanitizer keeps for this side
  };

  static void begin();
  static void go(Side& from, Side& to, bool for_good = false);

  std::function<void()> body_;
  Side outside_;
  Side inside_;
};

}  // namespace ex9000::registers
