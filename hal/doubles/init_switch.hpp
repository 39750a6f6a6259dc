#pragma once

namespace ex9000::hal::doubles {

class InitSwitch {
 public:
  [[nodiscard]] bool asserted() const { return asserted_; }
  void set(bool asserted) { asserted_ = asserted; }

 private:
  bool asserted_ = false;
};

}  // namespace ex9000::hal::doubles
