// Assertions, which only test builds check.
#pragma once

#ifdef EX9000_CHECKED

#include <cstdio>
#include <cstdlib>

namespace ex9000 {

/// A place with EX9000_EXPECT. The list has all places of a program, also those never reached.
class Expectation {
 public:
  explicit Expectation(const char* where) : where_(where), next_(all) { all = this; }
  Expectation(const Expectation&) = delete;
  Expectation& operator=(const Expectation&) = delete;

  void check(bool holds) {
    reached_ = true;
    if (!holds) {
      (void)std::fprintf(stderr, "does not hold: %s\n", where_);
      std::abort();
    }
  }

  [[nodiscard]] static const Expectation* first() { return all; }
  [[nodiscard]] const Expectation* next() const { return next_; }
  [[nodiscard]] const char* where() const { return where_; }
  [[nodiscard]] bool reached() const { return reached_; }

 private:
  static inline Expectation* all = nullptr;
  const char* where_;
  Expectation* next_;
  bool reached_ = false;
};

template <class Where>
struct ExpectationAt {
  static inline Expectation expectation{Where::text()};
};

}  // namespace ex9000

#define EX9000_TEXT_OF(line) #line
#define EX9000_PLACE(file, line, condition) file ":" EX9000_TEXT_OF(line) ": " condition
/// A test build aborts if this does not hold; images and releases do not evaluate it. Not for constexpr code.
#define EX9000_EXPECT(condition)                                                         \
  do {                                                                                   \
    struct Where {                                                                       \
      static const char* text() { return EX9000_PLACE(__FILE__, __LINE__, #condition); } \
    };                                                                                   \
    ::ex9000::ExpectationAt<Where>::expectation.check(condition);                        \
  } while (false)

#else

#define EX9000_EXPECT(condition) static_cast<void>(0)

#endif
