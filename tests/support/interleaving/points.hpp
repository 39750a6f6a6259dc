// The points at which an interrupt can occur between two accesses by the main loop.
#pragma once

#include <functional>
#include <utility>

namespace ex9000::interleaving {

/// Counts the points that the main loop passes, and calls a function at each one. Code that runs in an
/// interrupt passes no points, because interrupts do not interrupt each other.
class Points {
 public:
  /// Marks a point at which an interrupt can occur. Has no effect in an interrupt or outside `watch`.
  static void pass() {
    Points& points = instance();
    if (!points.in_interrupt_ && points.visit_) {
      points.visit_(points.passed_++);
    }
  }
  [[nodiscard]] static bool in_interrupt() { return instance().in_interrupt_; }

  /// Runs `code` as an interrupt.
  template <class Code>
  static void interrupt(Code code) {
    const Restored<bool> restored(instance().in_interrupt_);
    instance().in_interrupt_ = true;
    code();
  }

  /// Runs `code` as the main loop and calls `visit` at each point with its number, from 0. Returns the number
  /// of points.
  template <class Code>
  static unsigned watch(std::function<void(unsigned)> visit, Code code) {
    const Restored<std::function<void(unsigned)>> restored(instance().visit_);
    instance().visit_ = std::move(visit);
    instance().passed_ = 0;
    code();
    return instance().passed_;
  }

 private:
  /// Restores a variable at the end of a scope, even if the code under test throws.
  template <class T>
  class Restored {
   public:
    explicit Restored(T& variable) : variable_(variable), value_(variable) {}
    ~Restored() { variable_ = value_; }
    Restored(const Restored&) = delete;
    Restored& operator=(const Restored&) = delete;

   private:
    T& variable_;
    T value_;
  };

  static Points& instance() {
    static Points points;
    return points;
  }

  bool in_interrupt_ = false;
  unsigned passed_ = 0;
  std::function<void(unsigned)> visit_;
};

}  // namespace ex9000::interleaving
