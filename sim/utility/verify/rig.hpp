// What a line cannot do to a module: switch its supply, tie INIT*, drive its inputs, see its outputs and LED.
#pragma once

#include <stdexcept>
#include <string>

namespace ex9000::utility {

/// Something is missing to find out whether a module passes. The text says what.
struct NotVerified : std::runtime_error {
  using std::runtime_error::runtime_error;
};

class Rig {
 public:
  Rig() = default;
  Rig(const Rig&) = delete;
  Rig& operator=(const Rig&) = delete;
  virtual ~Rig() = default;

  /// `request`: as a control socket gets it, without the number of the module (sim/docs/verify.md). Returns
  /// the value that it asks for, when all is done. Throws NotVerified if the rig cannot do it,
  /// std::runtime_error if the rig is broken.
  virtual std::string ask(const std::string& request) = 0;
  /// Whether it can do no request that begins with this word, so that no run needs to begin in vain.
  [[nodiscard]] virtual bool never_does(const std::string& /*word*/) const { return false; }
};

/// Can do nothing.
class NoRig final : public Rig {
 public:
  std::string ask(const std::string& request) override {
    throw NotVerified("'" + request + "' requires a rig; see --rig");
  }
};

}  // namespace ex9000::utility
