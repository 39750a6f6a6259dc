#include "tests/mcu_model/fiber.hpp"

#include <sys/mman.h>

#include <cerrno>
#include <system_error>
#include <utility>

// Fiber must report each switch of stacks to AddressSanitizer.
#if defined(__has_feature)
#if __has_feature(address_sanitizer)
#define EX9000_ADDRESS_SANITIZER
#endif
#elif defined(__SANITIZE_ADDRESS__)
#define EX9000_ADDRESS_SANITIZER
#endif
#ifdef EX9000_ADDRESS_SANITIZER
#include <sanitizer/asan_interface.h>
#include <sanitizer/common_interface_defs.h>
#endif

namespace ex9000::registers {

namespace {

/// 1 MiB, because sanitizers make stack frames larger.
constexpr std::size_t kStackSize = std::size_t{1} << 20U;

thread_local Fiber* the_beginning = nullptr;

void leave_stack([[maybe_unused]] void** fake_stack, [[maybe_unused]] const void* to,
                 [[maybe_unused]] std::size_t size) {
#ifdef EX9000_ADDRESS_SANITIZER
  __sanitizer_start_switch_fiber(fake_stack, to, size);
#endif
}

void enter_stack([[maybe_unused]] void* fake_stack, [[maybe_unused]] const void** from,
                 [[maybe_unused]] std::size_t* size) {
#ifdef EX9000_ADDRESS_SANITIZER
  __sanitizer_finish_switch_fiber(fake_stack, from, size);
#endif
}

}  // namespace

Fiber::Fiber(std::function<void()> body) : body_(std::move(body)) {
  void* const stack =
      mmap(nullptr, kStackSize, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_STACK, -1, 0);
  if (stack == MAP_FAILED) {
    throw std::system_error(errno, std::generic_category(), "a fiber's stack");
  }
  inside_.stack = stack;
  inside_.stack_size = kStackSize;
  getcontext(&inside_.context);
  inside_.context.uc_stack.ss_sp = stack;
  inside_.context.uc_stack.ss_size = kStackSize;
  makecontext(&inside_.context, &Fiber::begin, 0);
}

Fiber::~Fiber() {
#ifdef EX9000_ADDRESS_SANITIZER
  // The frames that the fiber has not left are poisoned; something else may be mapped there later.
  __asan_unpoison_memory_region(inside_.stack, inside_.stack_size);
#endif
  munmap(const_cast<void*>(inside_.stack), inside_.stack_size);
}

void Fiber::resume() {
  the_beginning = this;
  go(outside_, inside_);
}

void Fiber::suspend() { go(inside_, outside_); }

void Fiber::begin() {
  Fiber& self = *the_beginning;
  enter_stack(nullptr, &self.outside_.stack, &self.outside_.stack_size);
  self.body_();
  go(self.inside_, self.outside_, true);
}

/// Switches from one side to the other. If `for_good` is true, `from` does not run again. Replaces
/// swapcontext(3), which AddressSanitizer does not fully support.
void Fiber::go(Side& from, Side& to, bool for_good) {
  leave_stack(for_good ? nullptr : &from.fake_stack, to.stack, to.stack_size);
  volatile bool left = false;  // volatile: getcontext returns a second time when the other side switches back
  getcontext(&from.context);
  if (!left) {
    left = true;
    setcontext(&to.context);
  }
  enter_stack(from.fake_stack, &to.stack, &to.stack_size);
}

}  // namespace ex9000::registers
