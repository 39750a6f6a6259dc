#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <utility>

#include "tests/mcu_model/fault.hpp"

namespace ex9000::registers {

/// A block of registers on the bus. Offsets are relative to its base address.
class Peripheral {
 public:
  explicit Peripheral(std::uint32_t base) : base_(base) {}
  Peripheral(const Peripheral&) = delete;
  Peripheral& operator=(const Peripheral&) = delete;
  virtual ~Peripheral() = default;

  [[nodiscard]] std::uint32_t base() const { return base_; }
  virtual std::uint32_t read(std::uint32_t offset) = 0;
  virtual void write(std::uint32_t offset, std::uint32_t value) = 0;

  /// Sets the function to call on every change of the interrupt line.
  void on_interrupt_line(std::function<void(bool)> act) { on_line_ = std::move(act); }

 protected:
  [[noreturn]] void fault(std::uint32_t offset, const std::string& what) const {
    throw Fault(base_ + offset, what);
  }
  void interrupt_line(bool asserted) {
    if (asserted != line_) {
      line_ = asserted;
      if (on_line_) {
        on_line_(asserted);
      }
    }
  }

 private:
  std::uint32_t base_;
  bool line_ = false;
  std::function<void(bool)> on_line_;
};

}  // namespace ex9000::registers
